"""Finds serial ports, boards on USB and running benches, without opening any; the port's own data tell them apart."""

from __future__ import annotations

import os
import tempfile
from dataclasses import dataclass
from pathlib import Path

from serial.tools import list_ports

from greywhale.errors import BAD_USAGE, UserError

BOARDS = {"mega": "Arduino Mega 2560", "nano": "Arduino Nano (ATmega328P)"}

# USB vendor and product numbers of boards that name themselves, and of the USB bridges on clones.
_KNOWN = {
    (0x2341, 0x0010): "mega",
    (0x2341, 0x0042): "mega",
    (0x2341, 0x0242): "mega",
    (0x2A03, 0x0010): "mega",
    (0x2A03, 0x0042): "mega",
}
# Their names mislead: the chip is another one.
_OTHERS = {(0x2341, 0x0058): "Arduino Nano Every, which greywhale does not run on"}
_BRIDGES = {0x1A86, 0x0403, 0x10C4, 0x067B}


@dataclass(frozen=True)
class Port:
    """One serial port; `board` is mega, nano or None where the port does not say; `bench` marks a simulated board."""

    device: str
    description: str
    board: str | None
    bench: bool
    usb: bool

    @property
    def likely(self) -> bool:
        """Whether a greywhale board may be behind it."""
        return self.bench or self.usb

    def as_dict(self) -> dict[str, object]:
        return {"port": self.device, "description": self.description, "board": self.board, "bench": self.bench}


def bench_directory() -> Path:
    """Where running benches leave a link to their port, named board-process: /tmp/greywhale-bench-1000/mega-4711."""
    return Path(tempfile.gettempdir()) / f"greywhale-bench-{os.getuid()}"


def find_ports() -> list[Port]:
    """List benches first, then every serial port of this machine."""
    return _benches() + _hardware()


def choose_port(named: str | None) -> str:
    """The port to use: the one named, or else the only one behind which a board may be."""
    if named is not None:
        return named
    likely = [port for port in find_ports() if port.likely]
    if len(likely) == 1:
        return likely[0].device
    if not likely:
        raise UserError(
            "no board was found on any serial port; plug it in, start a simulated one with `greywhale sim`, "
            "or name its port with --port.",
            BAD_USAGE,
        )
    names = ", ".join(port.device for port in likely)
    raise UserError(f"several ports may be the board: {names}; choose one with --port.", BAD_USAGE)


def board_of(device: str) -> str | None:
    """mega or nano, if the port named `device` says so."""
    real = os.path.realpath(device)
    for port in find_ports():
        if port.device == device or os.path.realpath(port.device) == real:
            return port.board
    return None


def _benches() -> list[Port]:
    directory = bench_directory()
    if not directory.is_dir() or directory.stat().st_uid != os.getuid():
        return []
    ports = []
    for link in sorted(directory.iterdir()):
        board, _, process = link.name.partition("-")
        # A killed bench leaves its link behind, and its pseudo-terminal may be somebody else's by now.
        if board in BOARDS and link.exists() and _runs(process):
            ports.append(Port(str(link), f"bench, simulated {BOARDS[board]}", board, bench=True, usb=False))
    return ports


def _runs(process: str) -> bool:
    try:
        os.kill(int(process), 0)
    except (ValueError, OverflowError, ProcessLookupError):
        return False
    except PermissionError:
        pass  # it runs, as somebody else
    return True


def _hardware() -> list[Port]:
    ports = []
    for found in sorted(list_ports.comports()):
        board = _KNOWN.get((found.vid or 0, found.pid or 0))
        other = _OTHERS.get((found.vid or 0, found.pid or 0))
        description = BOARDS[board] if board else other or found.description or "serial port"
        if board is None and found.vid in _BRIDGES:
            description = f"USB serial bridge, as many Arduino boards have ({found.description})"
        ports.append(Port(found.device, description, board, bench=False, usb=found.vid is not None))
    return ports
