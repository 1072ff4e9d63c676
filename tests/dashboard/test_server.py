"""The server over the loopback: its own pages come in, nobody else does, and nothing too large."""

from __future__ import annotations

import asyncio
import json
import socket as sockets
import threading
from collections.abc import Iterator
from concurrent.futures import ThreadPoolExecutor
from pathlib import Path
from urllib.parse import quote

import pytest
from starlette.types import Message, Receive, Scope, Send

from greywhale.base.errors import UserError
from greywhale.dashboard import server
from greywhale.dashboard.access import Access
from greywhale.dashboard.answers import Answers
from greywhale.dashboard.bucket import Bucket
from greywhale.dashboard.door import Door
from greywhale.dashboard.folder import Folder
from greywhale.dashboard.guard import Guard
from greywhale.dashboard.limits import REQUESTS
from greywhale.files.log.layout import HEADING, TITLE
from greywhale.protocol import schema
from greywhale.protocol.frames import FrameDecoder
from tests.dashboard.browser import BoardSocket, Page, RefusedError
from tests.dashboard.shared import Shared, jobs_of

INDEX = "<!doctype html><title>greywhale</title>"


@pytest.fixture
def page(shared: Shared, tmp_path: Path) -> Iterator[Page]:
    """A page of a server whose board lives as the test lets it."""
    files = tmp_path / "page"
    files.mkdir()
    (files / "index.html").write_text(INDEX)
    (files / "page.js").write_text("1")
    folder = tmp_path / "folder"
    folder.mkdir()
    (folder / "loop").symlink_to("loop")
    (folder / "a motion.csv").write_text("time_s,leader_0,leader_1,leader_2,leader_3\n")
    (folder / "a log.csv").write_text(f"# {TITLE}\n{HEADING}\n" + "".join(f"{t}{12 * ',0'},boot\n" for t in (1, 1.001)))
    listener = server.listen()
    port: int = listener.getsockname()[1]
    access = Access(port)
    answers = Answers(shared.relay, Folder(folder), "default", jobs_of(shared.relay, Folder(folder)))
    running = server.make_server(server.application(answers, files, access, port))
    thread = threading.Thread(target=running.run, args=([listener],), daemon=True)
    thread.start()
    opened = Page(port, access.token)
    opened.ticket = access.address().partition("=")[2]
    yield opened
    running.should_exit = True
    thread.join()


def test_the_pages_files_need_no_token_and_forbid_what_they_do_not_need(page: Page) -> None:
    stranger = Page(page.port, "")
    assert stranger.ask("GET", "/") == (200, INDEX.encode())
    assert stranger.ask("GET", "/page.js") == (200, b"1")
    assert stranger.ask("GET", "/../folder/a%20motion.csv")[0] == 404
    assert stranger.ask("POST", "/")[0] == 403


def test_all_else_needs_it(page: Page) -> None:
    state = page.get("/state")
    kinds = {one["name"]: one["kind"] for one in state["files"]}
    assert kinds == {"a log.csv": "log", "a motion.csv": "motion"}
    assert state["schema"] == f"{schema.SCHEMA_HASH:#010x}"
    for path in ("/state", "/history", "/board"):
        for token in ("", page.token + "x"):
            assert Page(page.port, token).ask("GET", path)[0] == 403
    for token in ("", "x"):
        with pytest.raises(RefusedError, match="403"):
            Page(page.port, token).open("/board")


def test_a_ticket_is_exchanged_for_the_token_once_and_by_its_own_page_alone(page: Page) -> None:
    stranger = Page(page.port, "")
    ticket = {"X-Greywhale-Ticket": page.ticket}
    assert stranger.ask("GET", "/enter", headers=ticket)[0] == 403
    assert stranger.ask("POST", "/enter", headers={**ticket, "Origin": "http://evil.example"})[0] == 403
    assert json.loads(stranger.ask("POST", "/enter", headers=ticket)[1]) == {"token": page.token}
    for headers in (ticket, {"X-Greywhale-Ticket": "é"}, {}):
        status, said = stranger.ask("POST", "/enter", headers=headers)
        assert (status, b"was used before, or is older than 10 minutes; press Enter" in said) == (403, True)


FOREIGN = [
    {"Host": "evil.example"},
    {"Host": "evil.example:{port}"},
    {"Host": "127.0.0.1"},
    {"Origin": "http://evil.example"},
    {"Origin": "http://127.0.0.1:1"},
    {"Origin": "https://127.0.0.1:{port}"},
    {"Origin": "null"},
]


def test_foreign_pages_and_names_get_nothing(page: Page) -> None:
    for foreign in FOREIGN:
        headers = {name: text.format(port=page.port) for name, text in foreign.items()}
        for path in ("/", "/state"):
            status, body = page.ask("GET", path, headers=headers)
            assert (status, b"use the address that it printed" in body) == (403, True), foreign
        with pytest.raises(RefusedError, match="403"):
            page.open("/board", host=headers.pop("Host", None), headers=headers)


def test_localhost_is_this_server_too(page: Page) -> None:
    own = f"localhost:{page.port}"
    assert page.ask("GET", "/state", headers={"Host": own, "Origin": f"http://{own}"})[0] == 200


def test_what_is_too_large_is_refused(page: Page) -> None:
    for length in (str(REQUESTS.most_body_bytes + 1), "x"):
        assert page.ask("POST", "/predict", headers={"Content-Length": length})[0] in (400, 413)
    with page.open("/board") as socket:
        with pytest.raises(ConnectionError, match="1009"):
            socket.say(bytes(REQUESTS.most_message_bytes + 1))  # more, unread at the end, would lose the server's word
            while True:
                socket.take()


def test_a_body_that_comes_in_pieces_breaks_off_where_it_is_too_long() -> None:
    pieces = [b"x" * REQUESTS.most_body_bytes, b"x", b"x"]
    got: list[str] = []

    async def inner(scope: Scope, receive: Receive, send: Send) -> None:
        while not got or got[-1] != "http.disconnect":
            got.append((await receive())["type"])

    async def receive() -> Message:
        return {"type": "http.request", "body": pieces.pop(0), "more_body": True}

    async def send(message: Message) -> None:
        raise AssertionError(message)

    scope: Scope = {"type": "http", "method": "POST", "path": "/jobs", "client": ("127.0.0.1", 2)}
    scope["headers"] = [(b"host", b"localhost:1"), (b"x-greywhale-token", b"secret")]
    guarded = Guard(inner, "secret", 1, lambda path: False, Door())(scope, receive, send)
    with ThreadPoolExecutor(1) as other:  # in this thread the page's tests may have left their browser's loop running
        other.submit(asyncio.run, guarded).result()
    assert got == ["http.request", "http.disconnect"]


def test_a_file_that_tells_no_torques_is_refused_with_the_verbs_sentence(page: Page) -> None:
    with page.open("/torque?file=default&filter_shift=1") as socket:
        said = socket.take()
        assert isinstance(said, str)
        assert "use a model.toml of greywhale identify" in json.loads(said)["error"]
        with pytest.raises(ConnectionError):
            socket.take()


def test_a_message_that_is_not_known_ends_the_connection(page: Page) -> None:
    for message in ({"kind": "dance"}, {"kind": 1}, {}):
        with page.open("/board") as socket:
            socket.say(message)
            with pytest.raises(ConnectionError, match="1003"):
                while True:
                    socket.take()


def test_a_bucket_lets_so_many_through() -> None:
    now = [0.0]
    bucket = Bucket(10.0, 3.0, lambda: now[0])
    assert [bucket.take() for _ in range(5)] == [True, True, True, False, False]
    now[0] = 0.2
    assert [bucket.take() for _ in range(3)] == [True, True, False]
    assert REQUESTS.owners[1] > 100, "a page that opens asks for some ten files"


def test_a_board_over_the_wire(page: Page, shared: Shared) -> None:
    def states(first: int) -> list[schema.State]:
        status, frames = page.ask("GET", f"/history?from={first}")
        assert status == 200
        samples = [schema.Sample.unpack(frame.payload) for frame in FrameDecoder().feed(frames)]
        assert [one.tick for one in samples] == list(range(first, first + len(samples)))
        return [one.state for one in samples]

    with page.open("/board") as one, page.open("/board") as other:
        driver, watcher = BoardSocket(one, shared.turn), BoardSocket(other, shared.turn)
        assert driver.word("link", open=True)["port"] == shared.relay.link["port"]
        driver.ask(schema.TelemetryRequest(1))
        driver.frame(schema.TelemetryReply.TYPE)
        first = schema.Sample.unpack(driver.frame(schema.Sample.TYPE).payload).tick
        one.say({"kind": "drive"})
        driver.word("driver", you=True)
        watcher.word("driver", you=False, free=False)
        other.say({"kind": "drive"})
        assert "Another page" in watcher.word("refused")["sentence"]
        driver.frame(schema.EnableReply.TYPE, driver.ask(schema.EnableRequest(0)))
        assert schema.State.SOFT_START in states(first)
        one.close()
        watcher.word("driver", free=True)
        shared.live(0.05)
        assert states(first)[-1] is schema.State.DISABLED


def test_a_log_comes_as_bytes_and_its_errors_as_a_terminals_sentence(page: Page) -> None:
    status, told = page.ask("GET", "/log?file=a%20log.csv")
    assert status == 200
    assert [schema.Sample.unpack(told[at : at + schema.Sample.SIZE]).tick for at in (0, schema.Sample.SIZE)] == [0, 1]
    for file, reason in (("a%20motion.csv", "column"), ("none.csv", "no such file"), ("../log.csv", "it is not in")):
        status, told = page.ask("GET", f"/log?file={file}")
        assert status == 400
        assert reason in json.loads(told)["error"]


def test_a_page_brings_fetches_renames_and_deletes_a_file(page: Page) -> None:
    log = f"# {TITLE}\n{HEADING}\n".encode()
    named = f"/file?name={quote('new é.csv')}"
    for address, status, told in (
        (named, 200, "new é.csv"),
        (named, 400, "exists already"),
        (f"{named}&if_there=rename", 200, "new é-2.csv"),
        (f"{named}&if_there=anyhow", 400, "if_there must be one of"),
        ("/file?name=../out.csv", 400, "it is not in"),
    ):
        answered, body = page.ask("PUT", address, log)
        assert (answered, told in json.loads(body)["name" if status == 200 else "error"]) == (status, True), body
    longer = log + bytes(REQUESTS.most_body_bytes)
    assert page.ask("PUT", "/file?name=long.csv", longer)[0] == 200, "a log is longer than words"
    assert page.ask("GET", named) == (200, log)
    assert page.ask("POST", "/file", {"name": "new é.csv", "to": "old.csv"})[0] == 200
    assert page.ask("DELETE", "/file?name=old.csv")[0] == 200
    assert page.ask("GET", "/file?name=old.csv")[0] == 400
    for method in ("PUT", "GET", "POST", "DELETE"):
        assert Page(page.port, "").ask(method, named, log)[0] == 403
        assert page.ask(method, named, log, {"Origin": "http://evil.example"})[0] == 403
    too_long = {"Content-Length": str(REQUESTS.most_upload_bytes + 1)}
    assert page.ask("PUT", named, headers=too_long)[0] == 413


def test_no_request_ends_in_a_traceback(page: Page, caplog: pytest.LogCaptureFixture) -> None:
    for target in ("x", "*", "http://127.0.0.1/", "board", "?"):
        with sockets.create_connection(("127.0.0.1", page.port)) as raw:
            request = f"GET {target} HTTP/1.1\r\nHost: 127.0.0.1:{page.port}\r\nConnection: close\r\n\r\n"
            raw.sendall(request.encode())
            answer = raw.makefile("rb").read()
        assert answer.startswith(b"HTTP/1.1 400 "), (target, answer)
    long, whole = "x" * 5000, [0] * len(schema.PARAMETERS)
    bodies: list[object] = [
        *({"raw": whole, "board": 1, "file": name} for name in (long, "x" * 300, "loop", "loop/a", "..", ".")),
        *({"raw": [10**400, *whole[1:]], "board": 1}, {"raw": whole, "board": 10**400}, {"raw": whole, "board": -1}),
        *({"verb": long}, {"verb": "info", "arguments": {long: 1}}, {}, {"raw": float("nan")}, {"raw": "\ud800"}),
        *([], 1, "x", None, b"", b"\xff", b'{"raw": 1e999}', b'{"raw": 1' + b"0" * 5000 + b"}", b'{"raw":' * 9000),
    ]
    bodies += [{"name": long, "to": "loop"}, {"name": 1}, {"answers": 1}, {"answers": "loop"}, {"answers": long}]
    for path in ("/predict", "/jobs", f"/jobs/{long}", "/file", "/questions"):
        for body in bodies:
            status, told = page.ask("POST", path, body)
            assert (status, json.loads(told).get("error", "").endswith((".", "]"))) == (400, True), (path, body, told)
    for method, path in (("GET", "arm"), ("GET", "controller"), ("GET", "log"), ("DELETE", "file"), ("PUT", "file")):
        for name in (long, "x" * 300, "loop", "loop/a", "%00", "%ff", "%ED%A0%80", "..", ".", "a%20log.csv/a"):
            assert (page.ask(method, f"/{path}?file={name}&name={name}")[0], path == "log") != (200, False), name
    for path in (f"/{long}", "/%00", "/%ff", "/a/" + "../" * 50, "//", "/page.js/x", "/page.js?" + long):
        assert page.ask("GET", path)[0] in (200, 400, 404, 405), path
    for name, text in (("Range", "bytes=9-1,x"), ("If-Modified-Since", long), ("If-None-Match", long)):
        assert page.ask("GET", "/page.js", headers={name: text})[0] in (200, 400, 416)
    assert [one for one in caplog.records if one.exc_info] == []


def test_a_history_from_nowhere(page: Page) -> None:
    for tick in ("-1", "x", "4294967296", "", "١", "²", "9" * 5000, "0" * 5000):
        status, body = page.ask("GET", f"/history?from={quote(tick)}")
        assert (status, "must be a tick" in json.loads(body)["error"]) == (400, True), tick


def test_without_its_files_a_sentence_says_what_to_do(tmp_path: Path) -> None:
    with pytest.raises(UserError, match="the page is not built; run `make setup`"):
        server.require_page(tmp_path)


def test_a_port_that_is_taken(page: Page) -> None:
    with pytest.raises(UserError, match=f"127.0.0.1:{page.port} is taken"):
        server.listen(page.port)
