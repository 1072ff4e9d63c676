"""Measures the dashboard server's cost while a page gets every tick, and the time until a page has the first one."""

from __future__ import annotations

import json
import os
import re
import socket
import subprocess
import sys
import tempfile
import time
from pathlib import Path
from urllib.request import Request as HttpRequest
from urllib.request import urlopen

from wsproto import ConnectionType, WSConnection
from wsproto.events import BytesMessage, Ping, Request

from greywhale.base.processes import start
from greywhale.dashboard.limits import SAMPLES
from greywhale.protocol import schema
from greywhale.protocol.frames import FrameDecoder, encode_frame
from tools.benchmarks.figure import Figure, at_most

SECONDS = SAMPLES.history / 1000
MOST_CPU, MOST_MB, FIRST_S, PREDICTED_S = 0.2, 200.0, 4.0, 0.05
PREDICTIONS = 20


def run() -> list[Figure]:
    with tempfile.TemporaryDirectory() as folder:
        begun = time.monotonic()
        command = [sys.executable, "-m", "greywhale", "dashboard", "--sim", "--no-browser", "--json"]
        server = start([*command, "--folder", folder], stdout=subprocess.PIPE, stderr=subprocess.DEVNULL)
        try:
            assert server.stdout is not None
            answer = json.loads(server.stdout.readline())
            page = _Page(int(re.findall(r":(\d+)/", answer["address"])[0]), answer["token"])
            page.samples()
            first_s = time.monotonic() - begun
            return [
                at_most("dashboard, from its start to the first sample", first_s, "s", FIRST_S),
                *_long_look(page, server.pid),
                *_prediction(page),
            ]
        finally:
            server.terminate()
            server.wait()


def _prediction(page: _Page) -> list[Figure]:
    """While samples come; the first one, which imports what it needs, does not count."""
    raw = json.dumps({"raw": list(schema.DEFAULTS), "board": int(schema.Board.MEGA2560)}).encode()
    page.ask("/predict", raw)
    begun = time.monotonic()
    for _ in range(PREDICTIONS):
        page.ask("/predict", raw)
    each_s = (time.monotonic() - begun) / PREDICTIONS
    return [at_most("dashboard, a predicted step and reach", 1000 * each_s, "ms", 1000 * PREDICTED_S)]


def _long_look(page: _Page, server: int) -> list[Figure]:
    """As long as the history."""
    ticks = [one.tick for one in page.samples()]
    first, count = ticks[0], len(ticks)
    cpu_s, begun = _cpu_s(server), time.monotonic()
    while (now := time.monotonic()) < begun + SECONDS:
        ticks = [one.tick for one in page.samples()]
        count += len(ticks)
        last = ticks[-1] if ticks else first
    share = (_cpu_s(server) - cpu_s) / (now - begun)
    memory_kb = int(re.findall(r"VmRSS:\s+(\d+)", Path(f"/proc/{server}/status").read_text())[0])
    lost = last - first + 1 - count
    megabytes = memory_kb / 1024
    return [
        at_most("dashboard, server, share of a core, every tick", share, "", MOST_CPU),
        at_most("dashboard, server, ten minutes of history", megabytes, "MB", MOST_MB),
        Figure("dashboard, samples lost in ten minutes", lost, "", "0", lost == 0),
    ]


def _cpu_s(process: int) -> float:
    fields = Path(f"/proc/{process}/stat").read_text().rpartition(")")[2].split()
    return (int(fields[11]) + int(fields[12])) / os.sysconf("SC_CLK_TCK")


class _Page:
    """A page that takes every tick and does nothing with it."""

    def __init__(self, port: int, token: str) -> None:
        self._address, self._token = f"http://127.0.0.1:{port}", token
        self._socket = socket.create_connection(("127.0.0.1", port))
        self._connection = WSConnection(ConnectionType.CLIENT)
        self._decoder = FrameDecoder()
        offered = ["greywhale", f"token.{token}"]
        self._socket.sendall(self._connection.send(Request(f"127.0.0.1:{port}", "/board", subprotocols=offered)))
        self._receive()
        every = encode_frame(schema.TelemetryRequest.TYPE, 1, schema.TelemetryRequest(1).pack())
        while not self._receive():  # until a board is there, and says something
            self._socket.sendall(self._connection.send(BytesMessage(data=every)))

    def samples(self) -> list[schema.Sample]:
        """The next ones."""
        while True:
            frames = self._decoder.feed(self._receive())
            found = [schema.Sample.unpack(one.payload) for one in frames if one.type == schema.Sample.TYPE]
            if found:
                return found

    def ask(self, path: str, body: bytes) -> None:
        with urlopen(HttpRequest(self._address + path, body, {"X-Greywhale-Token": self._token})) as answer:
            answer.read()

    def _receive(self) -> bytes:
        """The bytes of frames that have come; none where it was something else."""
        data = b""
        self._connection.receive_data(self._socket.recv(65536))
        for event in self._connection.events():
            if isinstance(event, Ping):
                self._socket.sendall(self._connection.send(event.response()))
            elif isinstance(event, BytesMessage):
                data += bytes(event.data)
        return data
