"""Joins a bench to its serial port and to the wall clock, a few milliseconds of simulated time after another."""

from __future__ import annotations

import math
from collections.abc import Callable
from pathlib import Path
from typing import Any, Protocol, cast

from greywhale_sim import eeprom_file, line
from greywhale_sim.bench import Bench
from greywhale_sim.pacing import Pacer, wants_real_time

REAL_TIME_SLICES = 4  # 1 ms: as often as a USB port is served
FAST_SLICES = 16  # a fifth of the time goes into the port otherwise
IDLE_SLICES = 32  # 8 ms, where nobody has opened the port
EEPROM_CHECK_S = 0.05  # between two looks whether the EEPROM has changed


class Port(Protocol):
    """The host's end of the serial line: a pseudo-terminal (serial_port.py), a TCP port (socket_port.py)."""

    path: str

    @property
    def connected(self) -> bool: ...
    def poll(self) -> bool: ...
    def baud(self) -> float: ...
    def read(self) -> bytes: ...
    def write(self, data: bytes) -> int: ...
    def backlog(self, limit: int) -> int: ...
    def discard_unread(self) -> None: ...
    def close(self) -> None: ...


class Server:
    """The bench behind a serial port; call `turn` again and again."""

    def __init__(
        self,
        bench: Bench,
        port: Port,
        fast: bool = False,
        eeprom: Path | None = None,
        pacer: Pacer | None = None,
        seed: int = 1,
        fast_slices: int = FAST_SLICES,
    ) -> None:
        self.bench = bench
        self.board = cast(Any, bench.board)
        self.port = port
        self.fast = fast
        self.noise = line.Noise()
        self.resets_by_host = 0
        self.ending = False
        self.while_waiting: Callable[[], None] = lambda: None  # called again and again while a host does not read
        self._seed = seed
        self._fast_slices = fast_slices
        self._cut_at: int | None = None  # EEPROM writes at which the power goes
        self._pacer = pacer or Pacer()
        self._eeprom = eeprom
        self._eeprom_kept = self.board.eeprom()
        self._eeprom_check_at = 0.0
        self._was_connected = False
        self._spoken_s = -math.inf  # when a byte last went over the line

    def turn(self) -> None:
        """One round: host to board, simulate, board to host, then let the wall clock catch up."""
        self._receive()
        real_time = self._keeps_real_time()
        self.bench.run_slices(
            IDLE_SLICES if not self.port.connected else REAL_TIME_SLICES if real_time else self._fast_slices
        )
        self._send()
        if self._cut_at is not None and self.board.stats().eeprom_writes >= self._cut_at:
            self.power_off()
        self._keep_eeprom()
        if not real_time:
            self._pacer.drain(self.port.backlog, self._host_stays)
        self._pacer.pace(self.bench.time_s, real_time)

    def power_off(self, after_writes: int = 0) -> None:
        """Cut the supply, at once or when the EEPROM has taken more bytes, also in the middle of an EEPROM write."""
        if after_writes > 0:
            self._cut_at = self.board.stats().eeprom_writes + after_writes
            return
        self._cut_at = None
        if self.board.powered:
            self._seed += 1  # another torn byte, another content of the RAM
            self.board.power_off(self._seed)
            self._keep_eeprom(now=True)

    def power_on(self) -> None:
        if not self.board.powered:
            self.board.power_on(self._seed)

    @property
    def rate(self) -> float:
        """Of simulated time while the bench keeps to the clock: 1 is real time, less is slow motion."""
        return self._pacer.rate

    @rate.setter
    def rate(self, rate: float) -> None:
        self._pacer.rate = rate

    def close(self) -> None:
        try:
            self._keep_eeprom(now=True)
        finally:
            self.port.close()

    def _receive(self) -> None:
        data = self.port.read()
        self.notice_host()  # after the read: bytes that follow an open at once must meet a board that was reset
        if data and self.board.powered:
            self._spoken_s = self.bench.time_s
            self.board.uart_send(self.noise(line.resample(data, self.port.baud(), self.board.baud)))

    def _send(self) -> None:
        data = self.board.uart_receive()
        if not self.port.connected:
            return
        if data:
            self._spoken_s = self.bench.time_s
            data = self.noise(line.resample(data, self.board.baud, self.port.baud()))
        self.port.write(data)  # without new data it sends what is kept

    def notice_host(self) -> None:
        """Take note of a host that has come or gone."""
        opened = self.port.poll()
        connected = self.port.connected
        if opened:
            self.resets_by_host += 1
            self.board.reset()
        if opened or (self._was_connected and not connected):
            self.port.discard_unread()
        self._was_connected = connected

    def _keeps_real_time(self) -> bool:
        return wants_real_time(
            self.fast,
            self.port.connected,
            self.board.in_bootloader,
            self.port.baud() if self.fast else 0.0,
            self.bench.wiring.bootloader_baud,
            self.bench.time_s - self._spoken_s,
        )

    def _host_stays(self) -> bool:
        self.notice_host()
        self.while_waiting()
        return self.fast and self.port.connected and not self.ending

    def _keep_eeprom(self, now: bool = False) -> None:
        if self._eeprom is None or not (now or self.bench.time_s >= self._eeprom_check_at):
            return
        self._eeprom_check_at = self.bench.time_s + EEPROM_CHECK_S
        content = self.board.eeprom()  # not a count of writes, which is ahead of a busy cell
        if content != self._eeprom_kept:
            eeprom_file.save(self._eeprom, content)
            self._eeprom_kept = content
