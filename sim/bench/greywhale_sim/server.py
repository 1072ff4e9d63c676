"""Joins a bench to its serial port and to the wall clock, one millisecond of simulated time after another."""

from __future__ import annotations

from pathlib import Path
from typing import Any

from greywhale_sim import eeprom_file, line
from greywhale_sim.bench import Bench
from greywhale_sim.pacing import Pacer, wants_real_time
from greywhale_sim.serial_port import SerialPort
from greywhale_sim.wiring import Wiring

CONNECTED_SLICES = 4  # 1 ms: as often as a USB port is served
IDLE_SLICES = 32
EEPROM_CHECK_S = 0.05


class Server:
    """The bench behind a serial port; call `turn` again and again."""

    def __init__(
        self,
        bench: Bench,
        board: Any,
        wiring: Wiring,
        port: SerialPort,
        fast: bool = False,
        eeprom: Path | None = None,
        pacer: Pacer | None = None,
    ) -> None:
        self.bench = bench
        self.board = board
        self.wiring = wiring
        self.port = port
        self.fast = fast
        self.noise = line.Noise()
        self.powered = True
        self.resets_by_host = 0
        self._pacer = pacer or Pacer()
        self._eeprom = eeprom
        self._eeprom_writes = board.stats().eeprom_writes
        self._eeprom_check_at = 0.0
        self._was_connected = False
        self._off_s = 0.0  # simulated time that passed without power, when the processor's clock stood still

    @property
    def time_s(self) -> float:
        return self.bench.time_s + self._off_s

    def turn(self) -> None:
        """One round: host to board, simulate, board to host, then let the wall clock catch up."""
        self._receive()
        slices = CONNECTED_SLICES if self.port.connected else IDLE_SLICES
        if self.powered:
            self.bench.run_slices(slices)
            self._send()
            self._keep_eeprom()
        else:
            self.bench.coast(slices)
        self._pace()

    def power_off(self) -> None:
        """Cut the supply at once, also in the middle of an EEPROM write."""
        if self.powered:
            self.powered = False
            self.board.power_off()
            self._keep_eeprom(now=True)

    def power_on(self) -> None:
        if not self.powered:
            self.powered = True
            self.board.power_on()

    def close(self) -> None:
        self._keep_eeprom(now=True)
        self.port.close()

    def _receive(self) -> None:
        data = self.port.read()
        self._notice_host()  # after the read: bytes written right after an open must meet the board already reset
        if data and self.powered:
            board_baud = self.board.baud
            self.board.uart_send(self.noise(line.resample(data, self.port.baud(), board_baud)))

    def _send(self) -> None:
        data = self.board.uart_receive()
        if data and self.port.connected:
            self.port.write(self.noise(line.resample(data, self.board.baud, self.port.baud())))

    def _notice_host(self) -> None:
        opened = self.port.poll()
        connected = self.port.connected
        if opened:
            self.resets_by_host += 1
            if self.powered:
                self.board.reset()
        if opened or (self._was_connected and not connected):
            self.port.discard_unread()
        self._was_connected = connected

    def _pace(self) -> None:
        real_time = wants_real_time(
            self.fast,
            self.port.connected,
            self.board.in_bootloader,
            self.port.baud() if self.fast else 0.0,
            self.wiring.bootloader_baud,
        )
        if self.fast and not real_time:
            self._pacer.drain(self.port.unread, self._host_stays)
        self._pacer.pace(self.time_s, real_time)

    def _host_stays(self) -> bool:
        self._notice_host()
        return self.port.connected

    def _keep_eeprom(self, now: bool = False) -> None:
        if self._eeprom is None or not (now or self.time_s >= self._eeprom_check_at):
            return
        self._eeprom_check_at = self.time_s + EEPROM_CHECK_S
        writes = self.board.stats().eeprom_writes
        if writes != self._eeprom_writes:
            self._eeprom_writes = writes
            eeprom_file.save(self._eeprom, self.board.eeprom())
