"""The application: routes, errors, checks and metrics put together."""

from __future__ import annotations

from collections.abc import AsyncIterator, Iterable
from contextlib import asynccontextmanager
from importlib.metadata import version

from fastapi import FastAPI
from starlette.types import ASGIApp

from search.server import errors
from search.server.guard import Guard
from search.server.metrics import Measured
from search.server.page import Page
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
    errors.install(app)
    for module in (search, motions, library, health):
        app.include_router(module.routes(state))
    app.mount("/", Page())
    # Around the app rather than among its middleware, so that even an unexpected error is counted and guarded.
    return Measured(Guard(app, host=host, names=names, token=token), state.metrics)
