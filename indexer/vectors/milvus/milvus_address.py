"""MilvusAddress: which collection of which Milvus server, or of which file of milvus-lite."""

from __future__ import annotations

import os
import re
from dataclasses import dataclass
from os import PathLike, fspath
from urllib.parse import urlsplit

from encoders.errors import ArgumentError

#: What tells an address from the path of a folder.
SCHEMES = ("milvus://", "milvus+tls://")
FILE_ENDING = ".db"
#: Where the secret of a server that wants one is, as "user:password" or a key; never in an address, which is printed.
TOKEN = "MOTIONSEEK_MILVUS_TOKEN"
#: The collection of a file.
_OF_FILE = "motionseek"
_PORT = 19530
_NAME = re.compile(r"[A-Za-z_][A-Za-z0-9_]{0,254}")


def is_milvus_address(place: str | PathLike[str]) -> bool:
    """Whether a place is an address of Milvus, or the file of milvus-lite, rather than a folder."""
    text = fspath(place)
    return text.startswith(SCHEMES) or (text.endswith(FILE_ENDING) and not os.path.exists(f"{text}/library.sqlite"))


@dataclass(frozen=True)
class MilvusAddress:
    """A collection and where it is.

    Attributes
    ----------
    text : str
        As it was given, for messages.
    uri : str
        As pymilvus takes it: of a server, or the path of a file.
    collection : str
    is_file : bool
        Whether milvus-lite serves it inside this process, which then is the only one that can.
    """

    text: str
    uri: str
    collection: str
    is_file: bool

    @classmethod
    def of(cls, text: str | PathLike[str]) -> MilvusAddress:
        """From "milvus://HOST:PORT/COLLECTION", "milvus+tls://..." or the path of a file, "NAME.db".

        Raises
        ------
        ArgumentError
            If it is none of these.
        """
        given = fspath(text)
        if not isinstance(given, str) or not is_milvus_address(given):
            raise ArgumentError(f"vectors={given!r} must be milvus://HOST:PORT/COLLECTION, or a file NAME{FILE_ENDING}")
        if not given.startswith(SCHEMES):
            return cls(given, os.path.abspath(given), _OF_FILE, True)
        parts = urlsplit(given)
        try:
            host, port = parts.hostname, parts.port or _PORT
        except ValueError:
            host, port = None, 0
        name = parts.path.strip("/")
        if parts.username or parts.password:
            raise ArgumentError(f"vectors: keep the secret out of the address and in {TOKEN}")
        if not host or not _NAME.fullmatch(name) or parts.query or parts.fragment:
            raise ArgumentError(
                f"vectors={given!r} must be milvus://HOST:PORT/COLLECTION, "
                "the collection of letters, digits and underscores"
            )
        scheme = "https" if parts.scheme == "milvus+tls" else "http"
        return cls(given, f"{scheme}://{f'[{host}]' if ':' in host else host}:{port}", name, False)

    @property
    def token(self) -> str:
        """The secret of the server; empty where it wants none."""
        return "" if self.is_file else os.environ.get(TOKEN, "")

    def __str__(self) -> str:
        return self.text
