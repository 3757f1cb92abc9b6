"""How much faster the bundle encodes motions than the plain way (needs torch).

    python -m benchmarks.encode sizes              random clips, by two sizes of encoder
    python -m benchmarks.encode windows [LIBRARY]  clips and all their windows, of the demo or of a library
    python -m benchmarks.encode recall             retrieval of synthetic clips in int8 and in floating point

The plain way is torch's own fp32 `nn.TransformerEncoder`, as published TMR uses it: batches of 32 in file order, padded
to the longest. Ours is `Bundle.encode_features`, whose weights are stored as int8 and which multiplies in int8 where
the processor has units for it. Both encode the same with the same sizes in one run, in turns, on the same number of
threads; the best of several rounds counts. CPU time is compared as well: on a busy machine it says more.
"""

from __future__ import annotations

import argparse
import tempfile
import time
import warnings
from collections.abc import Callable, Iterator, Mapping, Sequence
from functools import partial
from pathlib import Path
from typing import Any

import numpy as np
import torch
import torch.nn.functional as F
from numpy.typing import NDArray
from tokenizers import Tokenizer
from tokenizers.models import WordLevel
from torch import Tensor, nn

from benchmarks.moments import DEMO
from encoders.bundle import sessions
from encoders.bundle.batching import pad
from encoders.bundle.bundle import Bundle
from encoders.bundle.windows import encode_grids, grid
from encoders.corpus.composition.seeds import TEST
from encoders.corpus.composition.synthetic_pairs import synthetic_clips
from encoders.features.registry import FEATURE_KINDS
from encoders.motion import Motion
from encoders.tmr.conversion.to_bundle import export_bundle
from encoders.tmr.model.network import (
    TMR,
    TMRConfig,
    TransformerConfig,
    TransformerEncoder,
    group_frames,
    positions,
    valid_mask,
)
from encoders.tmr.text.language_model import LanguageConfig, LanguageModel, LanguageNetwork
from encoders.tmr.training.recipe import default_network
from indexer.ingest.load import load_motion
from indexer.store.stored_library import StoredLibrary
from search.evaluate.corpus_retrieval import evaluate_corpus

Array = NDArray[np.float32]
Encode = Callable[[Sequence[Array]], Array]

PUBLISHED = TMRConfig(decoder=None)


def plain(encoder: TransformerEncoder) -> Encode:
    """The encoder's weights in torch's own layers, used as published code uses them."""
    config = encoder.config
    layer = nn.TransformerEncoderLayer(
        config.width, config.heads, config.feedforward, config.dropout, "gelu", batch_first=True
    )
    stack = nn.TransformerEncoder(layer, config.layers).eval()
    stack.load_state_dict(encoder.seqTransEncoder.state_dict())

    def batch(clips: Sequence[Array]) -> Tensor:
        padded, lengths = pad(clips)
        x, mask = torch.from_numpy(padded), valid_mask(torch.from_numpy(lengths), padded.shape[1])
        x, mask = group_frames(x, mask, config.frames_per_token)
        tokens = torch.cat((encoder.tokens.expand(len(x), -1, -1), encoder.projection(x)), dim=1)
        tokens = tokens + positions(tokens.shape[1], config.width)
        out = stack(tokens, src_key_padding_mask=~F.pad(mask, (2, 0), value=True))
        return F.normalize(encoder.to_latent(out[:, 0]), dim=-1)

    def encode(clips: Sequence[Array]) -> Array:
        with torch.inference_mode():
            batches = [batch(clips[first : first + 32]) for first in range(0, len(clips), 32)]
            return torch.cat(batches).numpy()

    return encode


def bundle_of(encoder: TransformerEncoder, kind: str, folder: Path, threads: int) -> Bundle:
    """A bundle around a motion encoder; its text side is a stub."""
    sizes = LanguageConfig(
        vocabulary=8, width=8, layers=1, heads=1, feedforward=8, max_tokens=8, segments=0, norm_epsilon=1e-12
    )
    tokenizer = Tokenizer(WordLevel({"[UNK]": 0}, unk_token="[UNK]"))
    language = LanguageModel("stub", LanguageNetwork(sizes), tokenizer, max_tokens=8)
    text = TransformerConfig(8, width=8, layers=1, heads=1, feedforward=8)
    size = FEATURE_KINDS[kind].size
    export_bundle(
        folder,
        name="benchmark",
        motion_encoder=encoder,
        text_encoder=TransformerEncoder(text, encoder.latent),
        language=language,
        mean=np.zeros(size, np.float32),
        std=np.ones(size, np.float32),
        feature_kind=kind,
        max_frames=round(10 * FEATURE_KINDS[kind].fps),
    )
    return Bundle.load(folder, threads=threads)


def compare(name: str, encoder: TransformerEncoder, kind: str, *, clips: int, threads: int, rounds: int) -> float:
    """Time both ways in turns; print and return how many times as fast the bundle is."""
    fps, size = FEATURE_KINDS[kind].fps, FEATURE_KINDS[kind].size
    rng = np.random.default_rng(0)
    lengths = rng.integers(round(2 * fps), round(10 * fps) + 1, clips)
    features = [rng.standard_normal((length, size), dtype=np.float32) for length in lengths]
    with tempfile.TemporaryDirectory() as folder:
        ways = {
            "plain": plain(encoder.eval()),
            "bundle": bundle_of(encoder, kind, Path(folder) / "bundle", threads).encode_features,
        }
        latents = {way: encode(features) for way, encode in ways.items()}
        cosine = float((latents["plain"] * latents["bundle"]).sum(axis=1).min())
        wall, cpu = in_turns({way: partial(encode, features) for way, encode in ways.items()}, rounds)
    ratio, cpu_ratio = (times["plain"] / times["bundle"] for times in (wall, cpu))
    rates = ", ".join(f"{way} {clips / seconds:.0f} clips/s" for way, seconds in wall.items())
    print(f"{name}: {rates}: {ratio:.2f} times as fast ({cpu_ratio:.2f} by CPU time), cosine at least {cosine:.5f}")
    return ratio


def in_turns(ways: Mapping[str, Callable[[], object]], rounds: int) -> tuple[dict[str, float], dict[str, float]]:
    """The shortest seconds of each way, by the clock and on the processor."""
    wall: dict[str, list[float]] = {way: [] for way in ways}
    cpu: dict[str, list[float]] = {way: [] for way in ways}
    for _ in range(rounds):
        for way, call in ways.items():
            start, start_cpu = time.perf_counter(), time.process_time()
            call()
            wall[way].append(time.perf_counter() - start)
            cpu[way].append(time.process_time() - start_cpu)
    return {way: min(times) for way, times in wall.items()}, {way: min(times) for way, times in cpu.items()}


def windows(library: Path | None, *, clips: int, threads: int, rounds: int) -> float:
    """Time the clips and windows that an index holds, of real motions; print and return how many times as fast."""
    bundle = Bundle.load(threads=threads)
    features = [bundle.features(motion)[: bundle.max_frames] for motion in motions(library, clips)]
    durations = [len(rows) / bundle.fps for rows in features]
    network = TMR(default_network(features[0].shape[1], 384)).motion_encoder.eval()
    torch_way = plain(network)
    pieces = [
        rows[start : start + size]
        for rows in features
        for starts, size in grid(len(rows), bundle.fps).values()
        for start in starts
    ]
    whole = [*features, *pieces]
    ways: dict[str, Callable[[], object]] = {
        "plain": lambda: torch_way(whole),
        "bundle": lambda: (bundle.encode_features(features), encode_grids(bundle, features, durations)),
    }
    for call in ways.values():
        call()
    wall, cpu = in_turns(ways, rounds)
    ratio, cpu_ratio = (times["plain"] / times["bundle"] for times in (wall, cpu))
    exact, small = in_both(lambda either: either.encode_features(whole), threads)
    cosine = np.quantile((exact * small).sum(axis=1), (0, 0.01, 0.5))
    print(f"{len(features)} clips, {len(pieces)} windows, {sum(durations):.0f} s of motion, {threads} threads")
    times = f"plain {wall['plain']:.2f} s, bundle {wall['bundle']:.2f} s"
    print(f"{times}: {ratio:.2f} times as fast ({cpu_ratio:.2f} by CPU time)")
    print(f"cosine of int8 and floating point: least {cosine[0]:.4f}, 1 in 100 {cosine[1]:.4f}, median {cosine[2]:.5f}")
    return cpu_ratio


def motions(library: Path | None, count: int) -> Iterator[Motion]:
    """Real motions: of a library, drawn at random, else of the demo."""
    if library is None:
        yield from (load_motion(path) for path in sorted(DEMO.glob("*.bvh"))[:count])
        return
    with StoredLibrary.open(library) as stored:
        yield from (stored.motion(int(id)) for id in np.random.default_rng(0).permutation(stored.ids())[:count])


def recall(count: int, threads: int) -> float:
    """Print retrieval figures of synthetic clips in both arithmetics; the mean change of all recalls, in points."""
    clips = list(synthetic_clips(TEST, count, FEATURE_KINDS["body"]))
    exact, small = in_both(partial(evaluate_corpus, clips), threads)
    rows = [(name, k, exact[name][k], small[name][k]) for name in exact for k in exact[name]]
    for name, k, before, after in rows:
        print(f"{name:<34}{k:<14}{before:>8.1f}{after:>8.1f}{after - before:>+7.1f}")
    changes = [after - before for _, k, before, after in rows if k.startswith("R@")]
    print(f"{count} clips: recalls change by {np.mean(changes):+.2f} points on average, {min(changes):+.1f} at worst")
    return float(np.mean(changes))


def in_both(call: Callable[[Bundle], Any], threads: int) -> tuple[Any, Any]:
    """What a bundle gives in floating point and in int8, where this processor has units for it."""
    units, found = sessions.has_int8_units, []
    for has in (lambda: False, units):
        sessions.has_int8_units = has
        found.append(call(Bundle.load(threads=threads)))
    sessions.has_int8_units = units
    return found[0], found[1]


def main() -> None:
    """Print one of the comparisons."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("measure", choices=("sizes", "windows", "recall"))
    parser.add_argument("library", type=Path, nargs="?")
    parser.add_argument("--clips", type=int, default=256)
    parser.add_argument("--threads", type=int, default=torch.get_num_threads())
    parser.add_argument("--rounds", type=int, default=5)
    options = parser.parse_args()
    torch.set_num_threads(options.threads)
    torch.manual_seed(0)
    warnings.simplefilter("ignore")  # torch's nested tensors announce that they may change
    sizes = {"clips": options.clips, "threads": options.threads, "rounds": options.rounds}
    if options.measure == "windows":
        windows(options.library, **sizes)
    elif options.measure == "recall":
        recall(options.clips, options.threads)
    else:
        print(f"{options.clips} clips of 2 to 10 s, {options.threads} threads, best of {options.rounds}")
        compare("published TMR", TMR(PUBLISHED).motion_encoder, "humanml3d", **sizes)
        default = TMR(default_network(FEATURE_KINDS["body"].size, 384)).motion_encoder
        compare("default bundle", default, "body", **sizes)


if __name__ == "__main__":
    main()
