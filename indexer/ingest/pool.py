"""Read files in separate processes, so that one that crashes, hangs or exhausts memory fails alone.

A process has limits of time, memory and output, and what it answers is not trusted: nothing is allocated by its word
before it is checked.
"""

from __future__ import annotations

import json
import os
import signal
import subprocess
import sys
import threading
from collections import deque
from collections.abc import Iterable, Iterator
from concurrent.futures import Future, ThreadPoolExecutor
from contextlib import suppress
from dataclasses import dataclass, replace
from pathlib import Path
from typing import IO, Any, Generic, TypeVar

import numpy as np

from encoders.arguments import is_text
from encoders.errors import MotionSeekError, UnreadableMotion
from encoders.motion import Motion
from encoders.skeleton import JOINTS
from indexer.formats.opening import size
from indexer.ingest import worker_limits
from indexer.ingest.worker import MAX_FRAMES, MAX_HEADER, MAX_REASON, READY, TOO_MUCH_MEMORY
from indexer.read_motion import Reading, ReadMotion

READ = "indexer.ingest.load:read_motions"

#: Seconds a file may take, and those added for each MB.
PATIENCE, PATIENCE_A_MB = 60.0, 2.0

#: Share of that for which the processor may be used. Who uses it longer does so again; other delays may pass.
PATIENCE_OF_PROCESSOR = 0.9

#: Results that may queue for each process: enough to keep all busy while one reads a long file.
_AHEAD = 4

#: Seconds a process may take to exit after its last output.
_ENDING = 5.0

_START = (
    "import json, sys; path, target, parent = json.loads(sys.argv[1]); sys.path[:] = path; "
    "from indexer.ingest.worker import serve; serve(target, parent)"
)

Key = TypeVar("Key")


@dataclass(frozen=True)
class Read:
    """The result for a file: its motions, or the reason why there is none.

    `passes` tells a reason that does not lie in the file's content, so that reading it again may succeed; `doubted` one
    that may or may not, as the process crashed.
    """

    clips: tuple[ReadMotion, ...] = ()
    reason: str = ""
    passes: bool = False
    doubted: bool = False

    @property
    def frames(self) -> int:
        """Of all motions together."""
        return sum(len(clip.motion) for clip in self.clips)


@dataclass(frozen=True)
class Request(Generic[Key]):
    """A file to read; `key` is returned with the result."""

    key: Key
    path: Path
    fps: float | None = None
    joint_map: dict[str, str] | None = None
    up: str | None = None


def read_all(
    requests: Iterable[Request[Key]], jobs: int, *, patience: float = PATIENCE, target: str = READ
) -> Iterator[tuple[Key, Read]]:
    """Read files in `jobs` processes; results come in the order of the requests.

    Few requests are taken ahead of the results that are consumed, so that memory does not grow with their number.

    Parameters
    ----------
    patience : float
        Seconds a small file may take before its process is killed.
    target : str
        "module:function" that reads; see `indexer.ingest.worker.serve`.

    Raises
    ------
    MotionSeekError
        If processes cannot be started, whatever the files are.
    """
    workers: list[_Worker] = []
    local = threading.local()

    def read(request: Request[Key]) -> Read:
        if not hasattr(local, "worker"):
            local.worker = _Worker(target)
            workers.append(local.worker)
        answer: Read = local.worker.read(request, patience)
        return answer

    pool = ThreadPoolExecutor(jobs, thread_name_prefix="reading")
    waiting: deque[tuple[Key, Future[Read]]] = deque()
    try:
        for request in requests:
            waiting.append((request.key, pool.submit(read, request)))
            while len(waiting) > _AHEAD * jobs or (waiting and waiting[0][1].done()):
                key, future = waiting.popleft()
                yield key, future.result()
        while waiting:
            key, future = waiting.popleft()
            yield key, future.result()
    finally:
        for _, future in waiting:
            future.cancel()
        for worker in workers:
            worker.end()
        pool.shutdown(cancel_futures=True)


class _Worker:
    """One reading process, started when it is needed and again after it has died."""

    def __init__(self, target: str) -> None:
        self._target = target
        self._process: subprocess.Popen[bytes] | None = None
        self._ended = False

    def read(self, request: Request[Any], patience: float) -> Read:
        if self._ended:
            return Read(reason="interrupted", passes=True)
        process = self._process or self._start()
        late = threading.Event()

        def give_up() -> None:
            late.set()
            process.kill()

        length = 0
        with suppress(OSError, UnreadableMotion):  # the reader reports it better
            length = size(request.path)
        patience += PATIENCE_A_MB * length / 1e6
        timer = threading.Timer(patience, give_up)
        timer.start()
        try:
            return _ask(process, request, worker_limits.memory_for(length), PATIENCE_OF_PROCESSOR * patience)
        except _Nonsense as error:
            self._process = None
            process.kill()
            _wait(process)
            return Read(reason=f"reading it gave no motion ({error}); please report it with the file")
        except (OSError, EOFError):
            self._process = None
            return _ended(_wait(process), patience if late.is_set() else None)
        finally:
            timer.cancel()

    def _start(self) -> subprocess.Popen[bytes]:
        # Isolated, then given this process's own import path: nothing in the working directory is imported.
        path = [entry for entry in sys.path if entry] + [str(Path(__file__).parents[2])]
        try:
            process = self._process = subprocess.Popen(
                [sys.executable, "-I", "-c", _START, json.dumps([path, self._target, os.getpid()])],
                stdin=subprocess.PIPE,
                stdout=subprocess.PIPE,
                stderr=subprocess.DEVNULL,
                env={**os.environ, "OMP_NUM_THREADS": "1", "OPENBLAS_NUM_THREADS": "1"},
            )
        except OSError as error:
            raise MotionSeekError(f"{sys.executable}: a process to read files cannot be started ({error})") from error
        assert process.stdout is not None
        if process.stdout.readline() != READY and not self._ended:
            raise MotionSeekError(
                f"a process to read files ends as it starts (exit code {_wait(process)}); "
                f"'{sys.executable} -m indexer.ingest.worker' shows why"
            )
        return process

    def end(self) -> None:
        """Kill the process."""
        self._ended = True
        process = self._process  # the reading thread sets it to None once the process is dead
        if process is not None:
            process.kill()
            _wait(process)


class _Nonsense(Exception):
    """An answer that no reading process gives unless a file has made it do so."""


def _ask(process: subprocess.Popen[bytes], request: Request[Any], memory: int, seconds: float) -> Read:
    """Send one request and receive its result. Raises OSError or EOFError if the process dies, or `_Nonsense`."""
    assert process.stdin is not None
    assert process.stdout is not None
    message = {"path": str(request.path), "fps": request.fps, "joint_map": request.joint_map, "up": request.up}
    process.stdin.write(json.dumps({**message, "memory": memory, "seconds": seconds}).encode() + b"\n")
    process.stdin.flush()
    line = process.stdout.readline(MAX_HEADER)
    if not line:
        raise EOFError
    try:
        header = json.loads(line)
        if "reason" in header:
            passes, doubted = header["passes"] is True, header["doubted"] is True
            return Read(reason=_text(header["reason"], MAX_REASON), passes=passes, doubted=doubted)
        records = header["clips"]
        counts = [record["frames"] for record in records]
        if not counts or not all(type(count) is int and count > 0 for count in counts) or sum(counts) > MAX_FRAMES:
            raise ValueError("impossible numbers of frames")
        return Read(tuple(_received(process.stdout, record) for record in records))
    except (ValueError, TypeError, KeyError, AttributeError, OverflowError, RecursionError) as error:
        raise _Nonsense(f"{type(error).__name__}: {error}"[:MAX_REASON]) from error


def _received(stream: IO[bytes], record: dict[str, Any]) -> ReadMotion:
    """One motion of a response, of a number of frames that is checked. Raises EOFError if the process dies."""
    size = record["frames"] * len(JOINTS) * 3 * 4
    data = stream.read(size)
    if len(data) < size:
        raise EOFError
    motion = Motion(np.frombuffer(data, np.float32).reshape(-1, len(JOINTS), 3), record["fps"])
    return ReadMotion(motion, _text(record["part"]), _text(record["rig"]), _reading(record["reading"]))


def _reading(record: dict[str, Any]) -> Reading:
    """How a motion was read, of the types that the library stores."""
    found = Reading.of(record)
    for text in (found.take, found.up, found.up_reason, *found.warnings):
        _text(text)
    numbers = (found.start, found.source_fps, found.source_frames)
    if not all(type(number) in (int, float) and 0 <= number < 1e15 for number in numbers):
        raise ValueError("impossible times")
    return replace(found, source_frames=int(found.source_frames))


def _text(value: Any, longest: int = MAX_HEADER) -> str:
    if not isinstance(value, str) or len(value) > longest or not is_text(value):
        raise ValueError("no text")
    return value


def _wait(process: subprocess.Popen[bytes]) -> int:
    """The exit code of a process that is ending; one that does not end is killed."""
    for pipe in (process.stdin, process.stdout):
        if pipe is not None:
            with suppress(OSError):
                pipe.close()
    with suppress(subprocess.TimeoutExpired):
        return process.wait(_ENDING)
    process.kill()
    return process.wait()


def _ended(code: int, patience: float | None) -> Read:
    """What it means for a file that its process has ended."""
    if patience is not None:
        return Read(reason=f"reading took more than {patience:.0f} s and was ended", passes=True)
    if code == -signal.SIGKILL:
        return Read(reason="reading it was killed, perhaps because memory ran out", passes=True)
    if code == -getattr(signal, "SIGXCPU", 0):
        return Read(reason="reading it took too long and was ended; cut it into shorter takes")
    if code == worker_limits.OVER_MEMORY:
        return Read(reason=TOO_MUCH_MEMORY)
    name = signal.Signals(-code).name if code < 0 else f"exit code {code}"
    passes = name in ("SIGTERM", "SIGHUP", "SIGINT")
    return Read(reason=f"reading it crashed ({name})", passes=passes, doubted=not passes)
