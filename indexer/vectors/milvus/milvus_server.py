"""MilvusServer: calls of a Milvus server that end in time, and errors that say what is wrong with it."""

from __future__ import annotations

import logging
import re
import threading
from collections import Counter
from collections.abc import Callable
from functools import partial
from typing import Any

from encoders.errors import LibraryError, LibraryLocked
from indexer.vectors.milvus.milvus_address import TOKEN, MilvusAddress

#: Seconds that a call may take with all its retries, which pymilvus makes, ever further apart.
TIMEOUT = 30.0
#: Seconds that the first contact may take.
_CONNECTING = 10.0
#: The oldest Milvus that has all that is asked of it, and the oldest milvus-lite.
_OLDEST, _OLDEST_LITE = (2, 4), (3, 0)
_VERSION = re.compile(r"(\d+)\.(\d+)")
#: How many have each file open in this process.
_users: Counter[str] = Counter()
_lock = threading.Lock()


class MilvusServer:
    """One server, or milvus-lite on a file inside this process.

    Parameters
    ----------
    address : MilvusAddress
    timeout : float
        Seconds that a call may take, retries among them.

    Raises
    ------
    LibraryError
        If pymilvus is not installed, or nothing answers at the address, or no Milvus that is new enough.
    LibraryLocked
        If another process has the file open.
    """

    def __init__(self, address: MilvusAddress, *, timeout: float = TIMEOUT) -> None:
        self.address, self._timeout, self._closed = address, timeout, False
        try:
            import pymilvus
        except ImportError:
            raise LibraryError("Milvus needs a further package; run: pip install 'motionseek[milvus]'") from None
        for name in ("pymilvus", "milvus_lite", "grpc._server"):  # they print tracebacks of what is raised as well
            logging.getLogger(name).setLevel(logging.CRITICAL)
        self._failures = _failures()
        try:
            self._client: Any = pymilvus.MilvusClient(
                uri=address.uri, token=address.token, timeout=min(timeout, _CONNECTING), dedicated=True
            )
            version = str(self._client.get_server_version(timeout=timeout))
        except self._failures as error:
            raise self._cause(error, "cannot be reached") from error
        self.is_lite = "lite" in version
        with _lock:
            _users[address.uri] += 1
        self._check(version)

    def _check(self, version: str) -> None:
        found = _VERSION.search(version)
        oldest = _OLDEST_LITE if self.is_lite else _OLDEST
        if found is None or (int(found[1]), int(found[2])) < oldest:
            name = "milvus-lite" if self.is_lite else "Milvus"
            self.close()
            raise LibraryError(
                f"{self.address}: is of version {version}; {name} {'.'.join(map(str, oldest))} or later is needed"
            )

    def call(self, method: str, *arguments: Any, **options: Any) -> Any:
        """What a method of pymilvus's client returns.

        Raises
        ------
        LibraryError
            If the server does not answer in time, or refuses.
        """
        made = partial(getattr(self._client, method), *arguments, **{"timeout": self._timeout} | options)
        return self.guarded(made, method.replace("_", " "))

    def guarded(self, step: Callable[[], Any], what: str = "reading") -> Any:
        """What a step of a conversation with the server returns; see `call`."""
        try:
            return step()
        except self._failures as error:
            raise self._cause(error, f"{what} failed") from error

    def close(self) -> None:
        """End the connection; a file is free for other processes when its last one in this process has ended."""
        if self._closed:
            return
        self._closed = True
        self._client.close()
        if not self.address.is_file:
            return
        from milvus_lite.server_manager import server_manager_instance

        with _lock:
            _users[self.address.uri] -= 1
            if not _users[self.address.uri]:
                server_manager_instance.release_server(self.address.uri)

    def _cause(self, error: Exception, what: str) -> LibraryError:
        said = " ".join(str(getattr(error, "message", "") or error).split())
        if self.address.is_file and "milvus_lite" not in said and what == "cannot be reached":
            return LibraryLocked(
                f"{self.address}: cannot be opened; where another process has it open, serve it to both: "
                f"milvus-lite server --data-dir {self.address}, and --vectors milvus://127.0.0.1:19530/"
                f"{self.address.collection}"
            )
        if any(word in said.lower() for word in ("unauthenticated", "auth check", "permission")):
            return LibraryError(f"{self.address}: does not let us in ({said[:200]}); put its secret into {TOKEN}")
        if any(word in said.lower() for word in ("unavailable", "deadline", "timeout", "connect")):
            return LibraryError(
                f"{self.address}: does not answer in time ({said[:200]}); is Milvus running there, and not overloaded?"
            )
        return LibraryError(f"{self.address}: {what} ({said[:300]})")


def _failures() -> tuple[type[Exception], ...]:
    import grpc
    from pymilvus.exceptions import MilvusException

    return (MilvusException, grpc.RpcError, OSError, ValueError)
