"""`motionseek serve`: the library as a web page and an HTTP API."""

from __future__ import annotations

import secrets
import webbrowser
from contextlib import suppress
from pathlib import Path
from typing import TYPE_CHECKING
from urllib.parse import quote

import click

from search.cli import options

if TYPE_CHECKING:
    from search.server.served.served_library import ServedLibrary


@click.command()
@click.argument("folder", required=False, type=click.Path(exists=True, file_okay=False))
@click.option("--vectors", metavar="milvus://HOST:PORT/NAME", help="Serve a collection of Milvus instead of a folder.")
@click.option("--poses", metavar="PLACE", help="Where its poses are: a folder, or s3://... and the like.")
@click.option("--port", type=options.Count(1, 65535), help="Port to listen on. [default: 8420, or the next free one]")
@click.option("--host", default="127.0.0.1", show_default=True, help="Address to listen on.")
@click.option("--allow-host", "names", metavar="NAME", multiple=True, help="Accept requests to this host name, too.")
@click.option(
    "--token",
    envvar="MOTIONSEEK_TOKEN",
    show_envvar=True,
    help="Secret that every request must carry, at least 16 characters.",
)
@click.option("--edit", is_flag=True, help="Let the page star, tag and collect clips.")
@click.option("--open", "browser", is_flag=True, help="Open the page in a browser.")
def serve(
    folder: str | None,
    vectors: str | None,
    poses: str | None,
    port: int | None,
    host: str,
    names: tuple[str, ...],
    token: str | None,
    edit: bool,
    browser: bool,
) -> None:
    """Serve the library of FOLDER as a web page and an HTTP API.

    Without FOLDER, serves the nearest library here or in a parent folder. The server is reachable from this computer
    only, unless --host is given. Clips indexed meanwhile are picked up at once. With --edit, the page can star, tag and
    collect clips; nothing else is ever written.

    \b
    Examples:
      motionseek serve my_mocap --open
      motionseek serve my_mocap --edit
      motionseek serve --port 9000
      motionseek serve --vectors milvus://10.0.0.5/mocap --poses /shared/poses
      MOTIONSEEK_TOKEN=... motionseek serve --host 0.0.0.0
    """
    try:
        import cachetools  # noqa: F401
        import fastapi  # noqa: F401
        import uvicorn  # noqa: F401
    except ImportError:
        raise click.ClickException(
            "the server needs further packages; run: pip install cachetools fastapi httptools uvicorn"
        ) from None

    from search.server.app import create_app
    from search.server.listen import address, listen
    from search.server.listen import serve as run
    from search.server.security import is_loopback

    if token is None and not is_loopback(host):
        raise click.UsageError(
            f"--host {host} admits other computers; give a token, such as --token {secrets.token_urlsafe(18)}"
        )
    if token is not None and len(token) < 16:
        raise click.UsageError("--token must have at least 16 characters")
    if token is not None and not all("!" <= character <= "~" for character in token):
        raise click.UsageError("--token must be ASCII without spaces, to be sent in a header")
    library = served(folder, vectors, poses, edit=edit)
    library.warm()
    listening = listen(host, port)
    url = address(listening, host) + (f"?token={quote(token, safe='')}" if token else "")

    def ready() -> None:
        click.echo(f"{len(library)} clips of {vectors or Path(library.folder)} at {url}  (press Ctrl-C to stop)")
        if browser:
            webbrowser.open(url)

    app = create_app(library, host=host, names=names, token=token, edit=edit)
    with suppress(KeyboardInterrupt):
        run(app, listening, ready=ready)
    click.echo("stopped", err=True)


def served(folder: str | None, vectors: str | None, poses: str | None, *, edit: bool) -> ServedLibrary:
    """The library to serve: that of a folder, or a collection of Milvus."""
    from search.cli.locate import locate, poses_of

    if vectors is not None and folder is not None:
        raise click.UsageError("FOLDER and --vectors cannot be combined: a collection is asked without any folder")
    place = vectors or locate(folder)
    if not isinstance(place, str):
        from search.server.snapshot_library import SnapshotLibrary

        if poses is not None:
            raise click.UsageError("--poses is for --vectors; a folder's library has the poses itself")
        return SnapshotLibrary.open(place)
    if edit:
        raise click.UsageError("--edit is for a folder: marks are kept in its library, and a collection shows them")
    from search.server.served.served_collection import ServedCollection

    return ServedCollection(place, poses=poses or poses_of(place))
