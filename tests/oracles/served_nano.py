"""avr8js/serve.js behind a pseudo-terminal, so that the host sees a serial port; opening it resets the board."""

from __future__ import annotations

import os
import signal
import subprocess
import threading
from types import TracebackType
from typing import Self

from greywhale_sim.serial_port import SerialPort
from tests.oracles.second_simulator import IMAGE, NODE, SCRIPTS

CHUNK = 4096
LOOK_S = 0.001  # how often the port is asked whether the host has written or opened it


class ServedNano:
    """A Nano that runs until the context is left; `path` is its serial port."""

    def __enter__(self) -> Self:
        self._port = SerialPort()
        self.path = self._port.path
        self._node = subprocess.Popen(
            ["node", str(SCRIPTS / "serve.js"), str(IMAGE)], env=NODE, stdin=subprocess.PIPE, stdout=subprocess.PIPE
        )
        self._ended = threading.Event()
        self._threads = [threading.Thread(target=pump) for pump in (self._to_host, self._from_host)]
        for thread in self._threads:
            thread.start()
        return self

    def __exit__(
        self, kind: type[BaseException] | None, error: BaseException | None, trace: TracebackType | None
    ) -> None:
        self._ended.set()
        self._node.terminate()
        self._node.wait()
        for thread in self._threads:
            thread.join()
        for pipe in (self._node.stdin, self._node.stdout):
            assert pipe is not None
            pipe.close()
        self._port.close()

    def _to_host(self) -> None:
        assert self._node.stdout is not None
        while data := os.read(self._node.stdout.fileno(), CHUNK):
            if self._port.connected:
                self._port.write(data)

    def _from_host(self) -> None:
        assert self._node.stdin is not None
        while not self._ended.wait(LOOK_S):
            if self._port.poll():
                self._port.discard_unread()
                self._node.send_signal(signal.SIGUSR2)
            if data := self._port.read():
                os.write(self._node.stdin.fileno(), data)
