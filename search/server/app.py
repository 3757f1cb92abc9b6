"""The ASGI application: routes, exception handlers and middleware."""

from __future__ import annotations

from collections.abc import AsyncIterator, Iterable
from contextlib import asynccontextmanager
from importlib.metadata import version

from fastapi import Depends, FastAPI
from starlette.types import ASGIApp, Message, Receive, Scope, Send

from search.server import exception_handlers
from search.server.app_state import AppState
from search.server.parameters import known_parameters
from search.server.prometheus import MetricsMiddleware
from search.server.routes import composing, health, library, motions, search, shelf, uploads
from search.server.security import SecurityMiddleware
from search.server.served.served_library import ServedLibrary
from search.server.static_page import StaticPage
from search.server.uploads.upload_store import UploadLimits


def create_app(
    served: ServedLibrary,
    *,
    host: str = "127.0.0.1",
    names: Iterable[str] = (),
    token: str | None = None,
    limits: UploadLimits | None = None,
    edit: bool = False,
) -> ASGIApp:
    """The application for one library; closes the library at shutdown.

    Parameters
    ----------
    host : str
        The address the server is bound to.
    names : iterable of str
        Further host names that requests may use.
    token : str, optional
        The secret that every request must carry.
    limits : UploadLimits, optional
        Resource limits of uploads.
    edit : bool
        Whether requests may star, tag and collect clips.
    """
    state = AppState(served, limits, edit=edit)

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
    exception_handlers.install(app)
    for module in (search, motions, uploads, library, shelf, composing):
        app.include_router(module.routes(state), dependencies=[Depends(known_parameters)])
    app.include_router(health.routes(state))
    app.mount("/", StaticPage())
    # Wrapped around the app, not added to its middleware: responses to unexpected exceptions pass these, too.
    guarded = SecurityMiddleware(app, host=host, names=names, token=token)
    return HeadMiddleware(MetricsMiddleware(guarded, state.metrics))


class HeadMiddleware:
    """Answers HEAD as GET without the body; FastAPI's routes accept GET only."""

    def __init__(self, app: ASGIApp) -> None:
        self._app = app

    async def __call__(self, scope: Scope, receive: Receive, send: Send) -> None:
        async def send_head(message: Message) -> None:
            await send({**message, "body": b""} if message["type"] == "http.response.body" else message)

        if scope["type"] == "http" and scope["method"] == "HEAD":
            await self._app({**scope, "method": "GET"}, receive, send_head)
        else:
            await self._app(scope, receive, send)
