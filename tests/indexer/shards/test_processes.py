"""Four indexers at once fill one collection through a server; some are killed, and their number changes."""

from __future__ import annotations

import random
import signal
import socket
import subprocess
import sys
import time
from collections.abc import Iterator
from contextlib import closing
from pathlib import Path

import numpy as np
import pytest

pytest.importorskip("milvus_lite")

from encoders.bundle.bundle import Bundle
from indexer.vectors.milvus.collection_schema import CLIPS, WINDOWS
from indexer.vectors.milvus.milvus_address import MilvusAddress
from indexer.vectors.milvus.milvus_collection import MilvusCollection
from tests.conftest import ROOT
from tests.search.conftest import made_motion

pytestmark = [pytest.mark.slow, pytest.mark.skipif(sys.platform == "win32", reason="SIGKILL")]

_INDEX = """
import sys
from encoders.bundle.bundle import Bundle
from indexer.ingest.indexing import index
folder, bundle, shard, vectors, library = sys.argv[1:]
index(folder, bundle=Bundle.load(bundle, threads=1), shard=shard, vectors=vectors, library=library, jobs=1)
"""


@pytest.fixture
def server(tmp_path: Path) -> Iterator[str]:
    """A server of milvus-lite in a process of its own; its address, with a collection."""
    with closing(socket.socket()) as free:
        free.bind(("127.0.0.1", 0))
        port = free.getsockname()[1]
    command = [sys.executable, "-m", "milvus_lite", "server", "--data-dir", str(tmp_path / "served.db")]
    process = subprocess.Popen(
        [*command, "--host", "127.0.0.1", "--port", str(port), "--max-workers", "1"], stdout=subprocess.DEVNULL
    )
    try:
        for _ in range(600):
            with closing(socket.socket()) as tried:
                if tried.connect_ex(("127.0.0.1", port)) == 0:
                    break
            time.sleep(0.1)
        yield f"milvus://127.0.0.1:{port}/mocap"
    finally:
        process.kill()
        process.wait()


def test_nothing_is_lost_or_doubled_whatever_dies(server: str, tmp_path: Path, tiny_bundle: Path) -> None:
    archive, chance = tmp_path / "archive", random.Random(0)
    archive.mkdir()
    for i in range(24):
        np.save(archive / f"take {i}.npy", made_motion(2.0, i).joints)

    def started(number: int, count: int) -> subprocess.Popen[bytes]:
        library = tmp_path / "shards" / str(number)
        given = [str(archive), str(tiny_bundle), f"{number}/{count}", server, str(library)]
        return subprocess.Popen([sys.executable, "-c", _INDEX, *given], cwd=ROOT)

    def run_all(count: int) -> None:
        assert [process.wait(300) for process in [started(number, count) for number in range(1, count + 1)]] == [
            0
        ] * count

    for _ in range(2):
        processes = [started(number, 4) for number in range(1, 5)]
        for process in processes:
            time.sleep(chance.uniform(0.5, 2.5))
            process.send_signal(signal.SIGKILL)
        for process in processes:
            process.wait()
    run_all(4)
    assert paths_in(server, tiny_bundle) == {path.name for path in archive.iterdir()}
    (archive / "take 3.npy").unlink()
    run_all(3)
    assert paths_in(server, tiny_bundle) == {path.name for path in archive.iterdir()}


def paths_in(address: str, tiny_bundle: Path) -> set[str]:
    """The paths of the clips of a collection, each once and with windows that are its own."""
    model = Bundle.load(tiny_bundle, threads=1)
    made = (model.fingerprint, model.name, model.latent_size)
    with closing(MilvusCollection(MilvusAddress.of(address), create=made)) as collection:
        clips = list(collection.all_rows(CLIPS, "", ("clip", "version", "path")))
        windows = {(row["clip"], row["version"]) for row in collection.all_rows(WINDOWS, "", ("clip", "version"))}
    assert windows == {(row["clip"], row["version"]) for row in clips}
    paths = [row["path"] for row in clips]
    assert len(paths) == len(set(paths))
    return set(paths)
