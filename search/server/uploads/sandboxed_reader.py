"""Reading an upload in a worker process with limits on memory and time, stricter than those for indexed files."""

from __future__ import annotations

from indexer.ingest import load
from indexer.read_motion import ReadMotion

READ = "search.server.uploads.sandboxed_reader:read"

#: Limits of the process: bytes of address space, seconds of CPU time.
MEMORY = 4 << 30
SECONDS = 60

#: Frames of the longest upload that is accepted: two hours at 20 a second.
MAX_FRAMES = 2 * 60 * 60 * 20


def read(
    path: str, fps: float | None = None, joint_map: dict[str, str] | None = None, up: str | None = None
) -> list[ReadMotion]:
    """`indexer.ingest.load.read_motions` under resource limits.

    Raises
    ------
    MemoryError
        If the motions are too long or a limit is reached.
    """
    limit_resources()
    clips = load.read_motions(path, fps, joint_map, up)
    if sum(len(clip.motion) for clip in clips) > MAX_FRAMES:
        raise MemoryError
    return clips


def limit_resources() -> None:
    """Set the limits of this process, where the system has such limits; elsewhere only the time-out remains."""
    try:
        import resource
    except ImportError:
        return
    for limit, value in ((resource.RLIMIT_AS, MEMORY), (resource.RLIMIT_CPU, SECONDS), (resource.RLIMIT_FSIZE, 0)):
        _, hard = resource.getrlimit(limit)
        resource.setrlimit(limit, (value if hard == resource.RLIM_INFINITY else min(value, hard), hard))
