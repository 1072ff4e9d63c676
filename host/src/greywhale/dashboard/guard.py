"""Lets only this machine's own pages in: checks host, origin and token of every request, bounds its size and rate.

A page of a foreign site may send requests here too, as the browser of this user does; and a foreign name may lead to
this address (DNS rebinding). Neither knows the token, and both say in their headers who they are.
"""

from __future__ import annotations

import asyncio
import hmac
from collections.abc import Callable

from starlette.responses import PlainTextResponse
from starlette.types import ASGIApp, Message, Receive, Scope, Send

from greywhale.dashboard.access import ANEW
from greywhale.dashboard.bucket import Bucket
from greywhale.dashboard.door import Door
from greywhale.dashboard.limits import REQUESTS

SUBPROTOCOL = "greywhale"
TOKEN_PREFIX = "token."
ENTRY = "/enter"  # where a ticket is exchanged for the token
UPLOAD = "/file"  # whose body may be longer

Refusal = tuple[int, str]
POLICY = "; ".join(
    [
        "default-src 'self'",
        "script-src 'self' 'wasm-unsafe-eval'",
        "img-src 'self' data: blob:",
        "object-src 'none'",
        "base-uri 'none'",
        "form-action 'none'",
        "frame-ancestors 'none'",
    ]
)
_HEADERS = [
    (b"content-security-policy", POLICY.encode()),
    (b"x-content-type-options", b"nosniff"),
    (b"referrer-policy", b"no-referrer"),
    (b"cross-origin-resource-policy", b"same-origin"),
    (b"cross-origin-opener-policy", b"same-origin"),
    (b"cache-control", b"no-store"),
]


class Guard:
    """An ASGI application around another one; `is_public` tells which paths anybody on this machine may read, and the
    `door` hears who has shown the token.
    """

    def __init__(self, inner: ASGIApp, token: str, port: int, is_public: Callable[[str], bool], door: Door) -> None:
        self._inner = inner
        self._token = token.encode()
        self._hosts = {f"{name}:{port}" for name in ("127.0.0.1", "localhost")}
        self._origins = {f"http://{host}" for host in self._hosts}
        self._is_public = is_public
        self.door = door
        self._owners = Bucket(*REQUESTS.owners)
        self._strangers = Bucket(*REQUESTS.strangers)

    async def __call__(self, scope: Scope, receive: Receive, send: Send) -> None:
        if scope["type"] == "lifespan":
            await self._inner(scope, receive, send)
            return
        refusal = self._refusal(scope) or await self._refusal_by_token(scope)
        most = _most_bytes(scope)
        if refusal is None and _length(scope) > most:
            refusal = (413, f"The request is larger than {most} bytes.")
        if refusal is not None:
            await PlainTextResponse(refusal[1], refusal[0], {"connection": "close"})(scope, receive, _hardened(send))
            return
        await self._inner(scope, _bounded(receive, most), _hardened(send))

    def _refusal(self, scope: Scope) -> Refusal | None:
        """Status and sentence for what comes from elsewhere, or leads there."""
        headers: dict[bytes, bytes] = dict(scope["headers"])
        names = [name for name, _ in scope["headers"]]
        if not scope["path"].startswith("/"):
            return 400, "The target of a request must begin with a slash."
        if names.count(b"host") != 1 or headers[b"host"].decode("latin-1") not in self._hosts:
            return 403, "This server answers to 127.0.0.1 and localhost alone; use the address that it printed."
        origin = headers.get(b"origin")
        if names.count(b"origin") > 1 or (origin is not None and origin.decode("latin-1") not in self._origins):
            return 403, "This server answers to its own pages alone; use the address that it printed."
        return None

    async def _refusal_by_token(self, scope: Scope) -> Refusal | None:
        """The refusal of a request by its token. With the token it does not wait; all others share one slow bucket."""
        if hmac.compare_digest(_token(scope), self._token):
            if not self.door.welcome(scope["client"]):
                return 503, "Too many pages are open; close some."
            return None if self._owners.take() else (429, "Too many requests; wait a second.")
        while not self._strangers.take():
            await asyncio.sleep(0.05)
            if not self.door.is_there(scope["client"]):
                return 408, "The connection was closed."
        if scope["type"] == "http" and (scope["method"], scope["path"]) == ("POST", ENTRY):
            return None
        if scope["type"] == "http" and scope["method"] in ("GET", "HEAD") and self._is_public(scope["path"]):
            return None
        return 403, f"The token is missing or not this server's; {ANEW}"


def _token(scope: Scope) -> bytes:
    """The token that a request shows: in a header, or beside the subprotocol where a browser sends no header."""
    if scope["type"] == "http":
        headers: dict[bytes, bytes] = dict(scope["headers"])
        return headers.get(b"x-greywhale-token", b"")
    offered: list[str] = scope["subprotocols"]
    if SUBPROTOCOL not in offered:
        return b""
    return next((one[len(TOKEN_PREFIX) :].encode() for one in offered if one.startswith(TOKEN_PREFIX)), b"")


def _most_bytes(scope: Scope) -> int:
    """The most that the body of a request may have."""
    uploads = scope["type"] == "http" and (scope["method"], scope["path"]) == ("PUT", UPLOAD)
    return REQUESTS.most_upload_bytes if uploads else REQUESTS.most_body_bytes


def _length(scope: Scope) -> int:
    """The length of the body that a request states; one that states none is counted while it comes."""
    for name, value in scope["headers"]:
        if name == b"content-length":
            return int(value) if value.isdigit() else REQUESTS.most_upload_bytes + 1
    return 0


def _bounded(receive: Receive, most: int) -> Receive:
    """The body of a request breaks off where it is too long."""
    had = 0

    async def bounded() -> Message:
        nonlocal had
        message = await receive()
        if message["type"] == "http.request":
            had += len(message.get("body", b""))
            if had > most:
                return {"type": "http.disconnect"}
        return message

    return bounded


def _hardened(send: Send) -> Send:
    """Every answer forbids what a page does not need."""

    async def hardened(message: Message) -> None:
        if message["type"] in ("http.response.start", "websocket.http.response.start"):
            message = {**message, "headers": [*message.get("headers", []), *_HEADERS]}
        await send(message)

    return hardened
