"""The HTTP server: the page's files, the board's WebSocket and what a page asks beside it."""

from __future__ import annotations

import asyncio
import json
import logging
import socket
from collections.abc import Awaitable, Callable
from functools import partial
from pathlib import Path
from typing import Any

import uvicorn
from starlette.applications import Starlette
from starlette.requests import ClientDisconnect, Request
from starlette.responses import JSONResponse, PlainTextResponse, Response
from starlette.routing import BaseRoute, Mount, Route, WebSocketRoute
from starlette.staticfiles import StaticFiles

from greywhale.base.errors import BadUsage, UserError, cut, os_reason
from greywhale.dashboard.access import ANEW, Access
from greywhale.dashboard.answers import Answers
from greywhale.dashboard.connections import Server
from greywhale.dashboard.door import Door
from greywhale.dashboard.folder import IF_THERE, Folder, spool
from greywhale.dashboard.guard import ENTRY, UPLOAD, Guard
from greywhale.dashboard.limits import REQUESTS
from greywhale.dashboard.sockets import serve_board, serve_host, serve_torque

PAGE = Path(__file__).resolve().parent / "page"
_BYTES = "application/octet-stream"
PAGE_ID = "page id"  # among what is asked: which page asks, by the name that its board's socket told it


def require_page(page: Path = PAGE) -> Path:
    if not (page / "index.html").is_file():
        raise UserError(f"{page}: the page is not built; run `make setup` in a checkout, or install greywhale again.")
    return page


def application(answers: Answers, page: Path, access: Access, port: int) -> Guard:
    """All that the server does, at this port of the loopback, for who has access."""
    routes: list[BaseRoute] = [
        Route(ENTRY, _entry(access), methods=["POST"]),
        WebSocketRoute("/board", partial(serve_board, relay=answers.relay)),
        WebSocketRoute("/host", partial(serve_host, jobs=answers.jobs)),
        WebSocketRoute("/torque", partial(serve_torque, relay=answers.relay, begin=answers.torque)),
        Route("/history", _endpoint(lambda asked: answers.history(asked.get("from")))),
        Route("/state", _endpoint(lambda asked: answers.state())),
        Route("/arm", _endpoint(lambda asked: answers.describe_arm(asked.get("file")))),
        Route("/controller", _endpoint(lambda asked: answers.controller(asked.get("file", "")))),
        Route("/log", _endpoint(lambda asked: answers.log(asked.get("file", "")))),
        Route("/file", _endpoint(lambda asked: answers.file(asked.get("name", ""))), methods=["GET"]),
        Route("/file", _endpoint(answers.rename), methods=["POST"]),
        Route("/file", _endpoint(lambda asked: answers.remove(asked.get("name", ""))), methods=["DELETE"]),
        Route(UPLOAD, _upload(answers.folder), methods=["PUT"]),
        Route("/questions", _endpoint(answers.questions), methods=["POST"]),
        Route("/predict", _endpoint(answers.predict), methods=["POST"]),
        Route("/calibrations", _endpoint(lambda asked: answers.calibrations()), methods=["GET"]),
        Route("/calibrations", _endpoint(answers.keep_calibration), methods=["POST"]),
        Route("/jobs", _endpoint(lambda asked: answers.jobs.listed()), methods=["GET"]),
        Route("/jobs", _endpoint(lambda asked: answers.jobs.start(asked, asked.get(PAGE_ID, ""))), methods=["POST"]),
        Route("/jobs/{id}", _endpoint(lambda asked: answers.jobs.stop(asked["id"])), methods=["DELETE"]),
        Route("/jobs/{id}/card", _endpoint(lambda asked: answers.jobs.put_away(asked["id"])), methods=["DELETE"]),
        Route(
            "/jobs/{id}", _endpoint(lambda asked: answers.jobs.say(asked["id"], asked.get("line"))), methods=["POST"]
        ),
    ]
    if (bench := answers.bench) is not None:
        routes += [
            Route("/bench", _endpoint(lambda asked: bench.controls()), methods=["GET"]),
            Route(
                "/bench", _endpoint(lambda asked: answers.change_bench(asked, asked.pop(PAGE_ID, ""))), methods=["POST"]
            ),
        ]
    private = {route.path for route in routes if isinstance(route, Route | WebSocketRoute)}
    first = {path.split("/")[1] for path in private}
    files = Mount("/", StaticFiles(directory=page, html=True))
    return Guard(
        Starlette(routes=[*routes, files]), access.token, port, lambda path: path.split("/")[1] not in first, Door()
    )


def listen(port: int = 0) -> socket.socket:
    """A socket on the loopback; port 0 is any free one."""
    listener = socket.socket()
    listener.setsockopt(socket.SOL_SOCKET, socket.SO_REUSEADDR, 1)
    try:
        listener.bind(("127.0.0.1", port))
    except OSError:
        listener.close()
        raise BadUsage(f"127.0.0.1:{port} is taken by another program; choose another --http-port.") from None
    listener.listen()
    return listener


def make_server(app: Guard) -> Server:
    """The server of an application; its `run` takes the sockets."""
    config = uvicorn.Config(
        app,
        http="h11",
        ws="wsproto",
        loop="asyncio",
        ws_max_size=REQUESTS.most_message_bytes,
        ws_per_message_deflate=False,
        timeout_graceful_shutdown=1,
        proxy_headers=False,  # a client's address is its own, whatever it says
        log_config=None,
        log_level=logging.ERROR,  # a warning for each odd request would let anybody fill the log
        access_log=False,
        server_header=False,
        lifespan="off",
    )
    return Server(config, app.door)


def _entry(access: Access) -> Callable[[Request], Awaitable[Response]]:
    async def enter(request: Request) -> Response:
        token = access.exchange(request.headers.get("x-greywhale-ticket", ""))
        if token is not None:
            return JSONResponse({"token": token})
        return PlainTextResponse(
            f"This address was used before, or is older than {REQUESTS.ticket_lasts_s / 60:.0f} minutes; {ANEW}", 403
        )

    return enter


def _upload(folder: Folder) -> Callable[[Request], Awaitable[Response]]:
    """Make the endpoint for a file of the folder: the body is its content, which is kept whole or not at all."""

    async def upload(request: Request) -> Response:
        name, if_there = request.query_params.get("name", ""), request.query_params.get("if_there", "refuse")
        try:
            chosen = next((one for one in IF_THERE if one == if_there), None)
            if chosen is None:
                raise BadUsage(f"if_there must be one of: {', '.join(IF_THERE)}.")
            with spool() as content:
                async for piece in request.stream():
                    await asyncio.to_thread(content.write, piece)
                return JSONResponse({"name": await asyncio.to_thread(folder.receive, name, content, chosen)})
        except UserError as error:
            return _refusal(error)
        except OSError as error:
            return _refusal(UserError(f"{cut(name)}: there is no room for it: {os_reason(error)}."))
        except ClientDisconnect:
            return Response(status_code=413)

    return upload


def _refusal(error: UserError) -> Response:
    return JSONResponse({"error": error.message, "exit_code": error.exit_code}, 400)


def _endpoint(answer: Callable[[dict[str, Any]], object]) -> Callable[[Request], Awaitable[Response]]:
    """Make an endpoint that answers with JSON or bytes, in a thread of its own, since `answer` takes a moment.

    The request's arguments are in its address, or are a JSON object in its body.
    """

    async def respond(request: Request) -> Response:
        try:
            asked = await _object(request) if request.method == "POST" else dict(request.query_params)
            asked |= request.path_params
            if (page := request.headers.get("x-greywhale-page")) is not None:
                asked[PAGE_ID] = page
            answered = await asyncio.to_thread(answer, asked)
            return Response(answered, media_type=_BYTES) if isinstance(answered, bytes) else JSONResponse(answered)
        except UserError as error:
            return _refusal(error)
        except ClientDisconnect:  # also what is too long breaks off so
            return Response(status_code=413)

    return respond


async def _object(request: Request) -> dict[str, Any]:
    try:
        content = await request.json()
        # What JSON itself does not know: NaN, infinite numbers, half of a letter.
        await asyncio.to_thread(lambda: json.dumps(content, allow_nan=False, ensure_ascii=False).encode())
    except (ValueError, RecursionError):
        content = None
    if not isinstance(content, dict):
        raise BadUsage("the body of the request must be a JSON object, of text and finite numbers.")
    return content
