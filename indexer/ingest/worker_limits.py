"""Limits of a reading process: of memory and processor time for each file, and its life ends with its parent's."""

from __future__ import annotations

import ctypes
import os
import signal
import sys
import threading
import time

#: Bytes a file may take to read, and those added for each byte of it, where the system has such limits (Linux). At most
#: half of the computer's memory.
MEMORY, MEMORY_A_BYTE = 1 << 30, 16

#: Linux's prctl option: the signal that the process gets when its parent dies.
_PR_SET_PDEATHSIG = 1
#: Seconds between looks at the parent where the system does not tell of its end.
_LOOK = 1.0


def memory_for(size: int) -> int:
    """Bytes of memory that reading a file of `size` bytes may take."""
    return min(MEMORY + MEMORY_A_BYTE * size, max(_physical() // 2, MEMORY))


def limit(memory: int, seconds: float) -> None:
    """Set the limits of this process for the next file; a later call sets them anew.

    Parameters
    ----------
    memory : int
        Bytes of private memory. Beyond it Python raises MemoryError.
    seconds : float
        Of processor time from now on, after which the system kills the process.
    """
    try:
        import resource
    except ImportError:  # Windows
        return
    used = sum(resource.getrusage(resource.RUSAGE_SELF)[:2])
    wanted = [(resource.RLIMIT_CPU, int(used + seconds) + 1)]
    if sys.platform == "linux":  # elsewhere it is no limit, or counts what libraries only reserve
        wanted.append((resource.RLIMIT_DATA, memory))
    for kind, value in wanted:
        _, hard = resource.getrlimit(kind)
        resource.setrlimit(kind, (value if hard == resource.RLIM_INFINITY else min(value, hard), hard))


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
