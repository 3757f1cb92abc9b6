"""Reading an upload, in the process that may be killed over it: less memory and time than a file of one's own gets."""

from __future__ import annotations

from encoders.motion import Motion
from indexer.ingest import worker

READ = "search.server.sandboxed_reader:read"

#: Bytes of address space and seconds of processor time an upload may cost.
MEMORY = 4 << 30
SECONDS = 60

#: Frames of the longest upload that is taken: two hours.
MOST_FRAMES = 2 * 60 * 60 * 20


def read(path: str, fps: float | None, joint_map: dict[str, str] | None) -> tuple[Motion, str]:
    """See `indexer.ingest.worker.read`; under limits."""
    _limit()
    motion, rig = worker.read(path, fps, joint_map)
    if len(motion) > MOST_FRAMES:
        raise MemoryError
    return motion, rig


def _limit() -> None:
    try:
        import resource
    except ImportError:  # where the system has no such limits, the patience of whoever waits remains
        return
    for limit, value in ((resource.RLIMIT_AS, MEMORY), (resource.RLIMIT_CPU, SECONDS), (resource.RLIMIT_FSIZE, 0)):
        _, most = resource.getrlimit(limit)
        resource.setrlimit(limit, (value if most == resource.RLIM_INFINITY else min(value, most), most))
