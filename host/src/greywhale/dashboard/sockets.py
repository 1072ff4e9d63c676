"""The WebSockets of a page: one carries a board's frames, unchanged; others tell how verbs go, and outside torques."""

from __future__ import annotations

import asyncio
import contextlib
import json
from collections.abc import Awaitable, Callable, Mapping

from starlette import status
from starlette.websockets import WebSocket, WebSocketDisconnect

from greywhale.base.errors import UserError
from greywhale.dashboard.bucket import Bucket
from greywhale.dashboard.client import Client
from greywhale.dashboard.guard import SUBPROTOCOL
from greywhale.dashboard.job import Facts
from greywhale.dashboard.jobs import Jobs
from greywhale.dashboard.limits import REQUESTS, SAMPLES
from greywhale.dashboard.outbox import Outbox
from greywhale.dashboard.relay import Relay
from greywhale.dashboard.torque import PagesTorque
from greywhale.observe import LIVE_EVERY_TICKS


class Waiting:
    """Lets a coroutine wait for an outbox that other threads fill."""

    def __init__(self) -> None:
        self._loop = asyncio.get_running_loop()
        self._some, self._urgent = asyncio.Event(), asyncio.Event()

    def notify(self, urgent: bool) -> None:
        """From any thread."""
        with contextlib.suppress(RuntimeError):  # the loop has ended
            self._loop.call_soon_threadsafe(self._note, urgent)

    def _note(self, urgent: bool) -> None:
        self._some.set()
        if urgent:
            self._urgent.set()

    async def wait(self, batch_s: float = SAMPLES.batch_s) -> None:
        """Until something is there; what is not urgent may gather for a moment."""
        await self._some.wait()
        with contextlib.suppress(TimeoutError):
            await asyncio.wait_for(self._urgent.wait(), batch_s)
        self._some.clear()
        self._urgent.clear()


async def serve_board(socket: WebSocket, relay: Relay) -> None:
    await socket.accept(SUBPROTOCOL)
    waiting = Waiting()
    client = Client(Outbox(waiting.notify))
    relay.join(client)
    sending = asyncio.create_task(_send(socket, client.outbox, waiting))
    try:
        await _receive(socket, client, relay)
    finally:
        relay.leave(client)
        sending.cancel()
        with contextlib.suppress(asyncio.CancelledError, WebSocketDisconnect):
            await sending


async def _send(socket: WebSocket, outbox: Outbox, waiting: Waiting) -> None:
    while True:
        await waiting.wait()
        answers, samples = outbox.take()
        for answer in answers:
            if isinstance(answer, bytes):
                await socket.send_bytes(answer)
            else:
                await socket.send_text(json.dumps(answer))
        if samples:
            await socket.send_bytes(samples)


async def _receive(socket: WebSocket, client: Client, relay: Relay) -> None:
    bucket = Bucket(*REQUESTS.messages)
    wishes: dict[str, Callable[[Client], None]] = {
        "drive": relay.drive,
        "release": relay.release,
        "here": relay.seen,
    }
    while True:
        message = await socket.receive()
        if message["type"] == "websocket.disconnect":
            return
        if not bucket.take():
            await socket.close(status.WS_1008_POLICY_VIOLATION, "too many messages")
            return
        if (data := message.get("bytes")) is not None:
            relay.receive(client, data)
            continue
        wish = wishes.get(_kind(message["text"]))
        if wish is None:
            await socket.close(status.WS_1003_UNSUPPORTED_DATA, "this message is not known")
            return
        wish(client)


async def serve_host(socket: WebSocket, jobs: Jobs) -> None:
    """Tell a page of all jobs, then of each that has changed, until the page goes."""
    await socket.accept(SUBPROTOCOL)
    waiting = Waiting()
    changed: dict[str, Facts] = {}

    def note(facts: Facts) -> None:
        changed[facts["id"]] = facts
        waiting.notify(False)

    async def tell() -> None:
        while True:
            for id in list(changed):
                await socket.send_text(json.dumps(changed.pop(id)))
            await waiting.wait()

    jobs.listeners.append(note)  # first, so that no change falls between
    for one in jobs.facts():
        changed.setdefault(one["id"], one)
    try:
        await _until_gone(socket, tell)
    finally:
        jobs.listeners.remove(note)


async def serve_torque(socket: WebSocket, relay: Relay, begin: Callable[[Mapping[str, str]], PagesTorque]) -> None:
    """Tell a page the torques from outside until it goes; where there are none, the reason in a sentence."""
    await socket.accept(SUBPROTOCOL)
    try:
        torque = await asyncio.to_thread(begin, dict(socket.query_params))
    except UserError as error:
        await socket.send_text(json.dumps({"error": error.message}))
        await socket.close()
        return
    waiting = Waiting()
    client = Client(Outbox(waiting.notify))
    client.every = LIVE_EVERY_TICKS

    async def tell() -> None:
        while True:
            await waiting.wait(SAMPLES.torque_s)
            _, samples = client.outbox.take()
            if (told := await asyncio.to_thread(torque.take, samples)) is not None:
                await socket.send_text(json.dumps(told))

    relay.join(client)
    try:
        await _until_gone(socket, tell)
    finally:
        relay.leave(client)


async def _until_gone(socket: WebSocket, tell: Callable[[], Awaitable[None]]) -> None:
    """Do this until the page goes, which has nothing to say here."""
    telling = asyncio.ensure_future(tell())
    try:
        while (await socket.receive())["type"] != "websocket.disconnect":
            pass
    finally:
        telling.cancel()
        with contextlib.suppress(asyncio.CancelledError, WebSocketDisconnect):
            await telling


def _kind(text: str) -> str:
    try:
        message = json.loads(text)
    except (ValueError, RecursionError):
        return ""
    kind = message.get("kind") if isinstance(message, dict) else None
    return kind if isinstance(kind, str) else ""
