"""The application: routes, errors, checks and metrics put together."""

from __future__ import annotations

from collections.abc import AsyncIterator, Iterable
from contextlib import asynccontextmanager
from importlib.metadata import version

from fastapi import FastAPI
from starlette.types import ASGIApp, Message, Receive, Scope, Send

from search.server import error_responses
from search.server.guard import Guard
from search.server.page import Page
from search.server.prometheus import Measured
from search.server.routes import health, library, motions, search
from search.server.served import ServedLibrary
from search.server.state import State
from search.server.uploads import Limits


def create_app(
    served: ServedLibrary,
    *,
    host: str = "127.0.0.1",
    names: Iterable[str] = (),
    token: str | None = None,
    limits: Limits | None = None,
) -> ASGIApp:
    """The server of one library, which it closes when it shuts down.

    Parameters
    ----------
    host : str
        What it is bound to.
    names : iterable of str
        Further names it is known by.
    token : str, optional
        What every request must carry.
    limits : Limits, optional
        What an upload may cost.
    """
    state = State(served, limits)

    @asynccontextmanager
    async def lifespan(_: FastAPI) -> AsyncIterator[None]:
        served.start()
        yield
        state.close()

    app = FastAPI(
        title="motionseek",
        summary="The search engine for human motion.",
        version=version("motionseek"),
        docs_url=None,
        redoc_url=None,
        lifespan=lifespan,
    )
    error_responses.install(app)
    for module in (search, motions, library, health):
        app.include_router(module.routes(state))
    app.mount("/", Page())
    # Around the app rather than among its middleware, so that even an unexpected error is counted and guarded.
    return Heads(Measured(Guard(app, host=host, names=names, token=token), state.metrics))


class Heads:
    """ASGI middleware: HEAD is answered as GET is, without the body. FastAPI's routes know GET alone."""

    def __init__(self, app: ASGIApp) -> None:
        self._app = app

    async def __call__(self, scope: Scope, receive: Receive, send: Send) -> None:
        async def send_head(message: Message) -> None:
            await send({**message, "body": b""} if message["type"] == "http.response.body" else message)

        if scope["type"] == "http" and scope["method"] == "HEAD":
            await self._app({**scope, "method": "GET"}, receive, send_head)
        else:
            await self._app(scope, receive, send)
