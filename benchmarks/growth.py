"""How time, memory and disk grow with a library, what kinds of index cost, and what a collection of Milvus does.

    python -m benchmarks.growth libraries --around REAL --folder SCRATCH --clips 1000 10000 100000
    python -m benchmarks.growth indexes --around REAL --clips 8000
    python -m benchmarks.growth milvus --around REAL --vectors milvus://127.0.0.1:19530/growth --clips 1000

REAL is an indexed folder; libraries are simulated around it (`benchmarks.simulated`). Each library is prepared, opened
and asked in processes of their own, whose peak memory is theirs alone. Times are of one thread's processor.
"""

from __future__ import annotations

import argparse
import multiprocessing
import resource
import tempfile
import time
from collections.abc import Callable
from contextlib import closing
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from benchmarks.simulated import asked, simulate
from indexer.shards.in_step import bring_in_step
from indexer.shards.shard import WHOLE
from indexer.store.library_reader import FILE
from indexer.store.stored_library import StoredLibrary
from indexer.vectors.library_indexes import WINDOWS
from indexer.vectors.milvus.milvus_address import MilvusAddress
from indexer.vectors.milvus.milvus_collection import MilvusCollection
from search.library import Library
from search.milvus_library import MilvusLibrary
from search.query.question import EncodedQuestion, Question

_NOISE = 0.35
_QUERIES = 40


def libraries(around: Path, folder: Path, counts: list[int]) -> None:
    """A row for each size: what it takes to prepare, to open and to ask, and on disk."""
    print(f"{'clips':>9}{'windows':>11}{'SQLite MB':>11}{'index MB':>10}{'prepare s':>11}{'its MB':>8}", end="")
    print(f"{'open s':>8}{'its MB':>8}{'ms p50':>8}{'ms p95':>8}", flush=True)
    for count in counts:
        place = folder / str(count)
        if not (place / FILE).is_file():
            simulate(place, around, count, _NOISE)
        preparing, of_preparing = _apart(_prepare, place)
        (opening, windows, times), of_asking = _apart(_ask, place)
        sizes = [sum(file.stat().st_size for file in place.glob(name)) for name in (FILE, "vectors/*/*")]
        p50, p95 = np.percentile(times, (50, 95))
        print(
            f"{count:>9,}{windows:>11,}{sizes[0] / 1e6:>11.0f}{sizes[1] / 1e6:>10.0f}{preparing:>11.1f}"
            f"{of_preparing:>8.0f}{opening:>8.2f}{of_asking:>8.0f}{p50:>8.1f}{p95:>8.1f}",
            flush=True,
        )


def _prepare(place: Path) -> float:
    began = time.process_time()
    with StoredLibrary.open(place) as library:
        library.prepare()
    return time.process_time() - began


def _ask(place: Path) -> tuple[float, int, list[float]]:
    with Library.open(place) as library:
        questions = _questions(library)
        began = time.process_time()
        library.search_encoded(questions[0], 10)
        opening = time.process_time() - began
        times = [_milliseconds(lambda q=q: library.search_encoded(q, 10)) for q in questions]
        return opening, int(library.stats()["windows"]), times


def _questions(library: Library) -> list[EncodedQuestion]:
    return [library.encode(Question.of(text, split_steps=False)) for text in asked(_QUERIES, seed=1)]


def _milliseconds(call: Callable[[], object]) -> float:
    began = time.process_time()
    call()
    return 1e3 * (time.process_time() - began)


def _apart(call: Callable[[Path], Any], place: Path) -> tuple[Any, float]:
    """What a call returns in a process of its own, and the process's peak memory in MB."""
    with multiprocessing.get_context("spawn").Pool(1) as pool:
        return pool.apply(_measured, (call, place))


def _measured(call: Callable[[Path], Any], place: Path) -> tuple[Any, float]:
    found = call(place)
    return found, resource.getrusage(resource.RUSAGE_SELF).ru_maxrss / 1e3


def indexes(around: Path, folder: Path, count: int) -> None:
    """Kinds of index, as Milvus has them too, by FAISS: recall of the ten nearest windows, time and bytes a row."""
    import faiss

    faiss.omp_set_num_threads(1)
    place = folder / str(count)
    if not (place / FILE).is_file():
        simulate(place, around, count, _NOISE)
    with Library.open(place) as library, library.reading() as connection:
        held = [rows.vectors for rows in library.indexes.stored(WINDOWS, connection)]
        vectors = np.concatenate(held).astype(np.float32)
        queries = np.concatenate([question.vectors for question in _questions(library)]).astype(np.float32)
    lists = round(4 * len(vectors) ** 0.5)
    kinds = {
        "Flat (all compared)": ("Flat", {}),
        "HNSW32, ef 128": ("HNSW32", {"efSearch": 128}),
        "HNSW32, ef 512": ("HNSW32", {"efSearch": 512}),
        "HNSW32 of 8 bits, ef 512": ("HNSW32_SQ8", {"efSearch": 512}),
        f"IVF{lists} of 8 bits, nprobe 64": (f"IVF{lists},SQ8", {"nprobe": 64}),
        f"IVF{lists}, PQ of 64 bytes, nprobe 64": (f"IVF{lists},PQ64", {"nprobe": 64}),
    }
    print(f"{len(vectors):,} windows of {count:,} clips")
    print(f"{'':<40}{'build s':>9}{'bytes a row':>13}{'ms':>8}{'recall@10':>11}")
    exact: NDArray[np.int64] | None = None
    made: dict[str, Any] = {}
    for name, (kind, parameters) in kinds.items():
        began = time.process_time()
        index = made.get(kind)
        if index is None:
            index = made[kind] = faiss.index_factory(vectors.shape[1], kind, faiss.METRIC_INNER_PRODUCT)
            index.train(vectors)
            index.add(vectors)
        building = time.process_time() - began
        for parameter, value in parameters.items():
            target = index.hnsw if parameter == "efSearch" else faiss.extract_index_ivf(index)
            setattr(target, parameter, value)
        size = len(faiss.serialize_index(index)) / len(vectors)
        began = time.process_time()
        _, found = index.search(queries, 10)
        each = 1e3 * (time.process_time() - began) / len(queries)
        exact = found if exact is None else exact
        recall = np.mean([len(set(a) & set(b)) / 10 for a, b in zip(found.tolist(), exact.tolist(), strict=True)])
        print(f"{name:<40}{building:>9.1f}{size:>13.0f}{each:>8.2f}{recall:>11.3f}", flush=True)


def milvus(around: Path, folder: Path, vectors: str, count: int) -> None:
    """A library sent into a collection, and asked there and here: rates, calls and whether the answers are the same."""
    place = folder / str(count)
    if not (place / FILE).is_file():
        simulate(place, around, count, _NOISE)
    with Library.open(place) as local:
        model = local.bundle
        made = (model.fingerprint, model.name, model.latent_size)
        with closing(MilvusCollection(MilvusAddress.of(vectors), create=made)) as collection:
            began = time.perf_counter()
            sent = bring_in_step(local, collection, WHOLE)
            sending = time.perf_counter() - began
            began = time.perf_counter()
            bring_in_step(local, collection, WHOLE)
            comparing = time.perf_counter() - began
        print(f"sent {sent.put:,} clips at {sent.put / sending:.0f} a second; compared again in {comparing:.1f} s")
        with MilvusLibrary(vectors, bundle=model) as distant:
            same, times, calls = 0, [], []
            call = distant.collection._server.call
            for question in _questions(local):
                counted: list[str] = []

                def counting(method: str, *given: Any, counted: list[str] = counted, **options: Any) -> Any:
                    counted.append(method)
                    return call(method, *given, **options)

                distant.collection._server.call = counting  # type: ignore[method-assign]
                began = time.perf_counter()
                found = distant.search_encoded(question, 10)
                times.append(1e3 * (time.perf_counter() - began))
                calls.append(len(counted))
                same += [hit.path for hit in found] == [hit.path for hit in local.search_encoded(question, 10)]
        p50, p95 = np.percentile(times, (50, 95))
        print(
            f"{same} of {_QUERIES} answers the same; {np.mean(calls):.1f} calls a question; {p50:.0f} ms, p95 {p95:.0f}"
        )


def main() -> None:
    """Run the command line."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("what", choices=("libraries", "indexes", "milvus"))
    parser.add_argument("--around", type=Path, required=True, help="an indexed folder of real motion")
    parser.add_argument(
        "--folder", type=Path, default=Path(tempfile.gettempdir(), "growth"), help="where simulated libraries are kept"
    )
    parser.add_argument("--clips", type=int, nargs="+", default=[1000])
    parser.add_argument("--vectors", default="milvus://127.0.0.1:19530/growth")
    given = parser.parse_args()
    if given.what == "libraries":
        libraries(given.around, given.folder, given.clips)
    elif given.what == "indexes":
        indexes(given.around, given.folder, given.clips[0])
    else:
        milvus(given.around, given.folder, given.vectors, given.clips[0])


if __name__ == "__main__":
    main()
