"""Limits of a reading process: of memory and processor time for each file, and its life ends with its parent's."""

from __future__ import annotations

import ctypes
import os
import re
import signal
import sys
import threading
import time
from pathlib import Path

#: Bytes a file may take to read, and those added for each byte of it. At most half of the computer's memory.
MEMORY, MEMORY_A_BYTE = 1 << 30, 16

#: Whether the system refuses memory beyond a limit. Elsewhere a thread looks at what is used, but for Windows.
LIMITS_MEMORY = sys.platform == "linux"
#: The exit code of a process that this thread ends.
OVER_MEMORY = 97

#: Linux's prctl option: the signal that the process gets when its parent dies.
_PR_SET_PDEATHSIG = 1
#: Seconds between looks at the parent where the system does not tell of its end, and at the memory used.
_LOOK, _LOOK_AT_MEMORY = 1.0, 0.05


def memory_for(size: int) -> int:
    """Bytes of memory that reading a file of `size` bytes may take."""
    return min(MEMORY + MEMORY_A_BYTE * size, max(_physical() // 2, MEMORY))


def limit(memory: int, seconds: float) -> None:
    """Set the limits of this process for the next file; a later call sets them anew.

    Parameters
    ----------
    memory : int
        Bytes of private memory. Beyond it Python raises MemoryError on Linux; on other systems but Windows the process
        ends with `OVER_MEMORY` within a moment.
    seconds : float
        Of processor time from now on, after which the system kills the process.
    """
    try:
        import resource
    except ImportError:  # Windows
        return
    used = sum(resource.getrusage(resource.RUSAGE_SELF)[:2])
    wanted = [(resource.RLIMIT_CPU, int(used + seconds) + 1)]
    if LIMITS_MEMORY:  # elsewhere it is no limit, or counts what libraries only reserve
        wanted.append((resource.RLIMIT_DATA, memory))
    else:
        memory_watch.limit(memory)
    for kind, value in wanted:
        _, hard = resource.getrlimit(kind)
        resource.setrlimit(kind, (value if hard == resource.RLIM_INFINITY else min(value, hard), hard))


class MemoryWatch:
    """A thread that ends the process once it takes more memory than it may, of what is resident."""

    def __init__(self) -> None:
        self._most = 0
        self._thread: threading.Thread | None = None

    def limit(self, memory: int) -> None:
        """Let it take so many bytes from now on, or what it has taken before: only the peak is known."""
        self._most = max(memory, _peak())
        if self._thread is None:
            self._thread = threading.Thread(target=self._look, daemon=True)
            self._thread.start()

    def _look(self) -> None:
        while _peak() <= self._most:
            time.sleep(_LOOK_AT_MEMORY)
        os._exit(OVER_MEMORY)


memory_watch = MemoryWatch()


def _peak() -> int:
    """Bytes of memory that were resident at most; not on Windows."""
    status = Path("/proc/self/status")  # of Linux, where getrusage counts what was resident before this program began
    if status.is_file() and (found := re.search(r"VmHWM:\s*(\d+)", status.read_text())):
        return int(found[1]) << 10
    import resource

    return resource.getrusage(resource.RUSAGE_SELF).ru_maxrss * (1 if sys.platform == "darwin" else 1024)


def die_with(parent: int) -> None:
    """End this process when its parent, of that process id, has ended: also when that was killed."""
    if sys.platform == "linux":
        ctypes.CDLL(None, use_errno=True).prctl(_PR_SET_PDEATHSIG, signal.SIGKILL)
        if os.getppid() != parent:  # it ended before
            os._exit(1)
    elif os.name == "posix":
        threading.Thread(target=_watch, args=(parent,), daemon=True).start()


def _watch(parent: int) -> None:
    while os.getppid() == parent:
        time.sleep(_LOOK)
    os._exit(1)


def _physical() -> int:
    """Bytes of memory the computer has; very many where that is not known."""
    try:
        return os.sysconf("SC_PAGE_SIZE") * os.sysconf("SC_PHYS_PAGES")
    except (AttributeError, ValueError, OSError):
        return 1 << 62
