"""Finds serial ports, boards on USB and running benches, without opening any; the port's own data tell them apart."""

from __future__ import annotations

import os
from dataclasses import dataclass
from pathlib import Path
from typing import TypedDict

from serial.tools import list_ports

from greywhale.base.errors import BadUsage
from greywhale.base.runtime import private_runtime_directories
from greywhale.protocol.transport import LINES

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
# Linux names ports in these folders by their device's own number, or by the socket that it is plugged into.
LASTING = (Path("/dev/serial/by-id"), Path("/dev/serial/by-path"))
_BRIDGES = {0x1A86, 0x0403, 0x10C4, 0x067B}


class PortFacts(TypedDict):
    port: str
    description: str
    board: str | None  # mega or nano, where the port tells
    bench: bool  # whether it is a simulated board


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

    def as_dict(self) -> PortFacts:
        return {"port": self.device, "description": self.description, "board": self.board, "bench": self.bench}


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
        raise BadUsage(
            "no board was found on any serial port; plug it in, start a simulated one with `greywhale sim`, "
            "or name its port with --port."
        )
    names = ", ".join(port.device for port in likely)
    raise BadUsage(f"several ports may be the board: {names}; choose one with --port.")


def is_bench(device: str) -> bool:
    """Whether the port named `device` is a simulated board's."""
    real = os.path.realpath(device)
    return device in LINES or any(port.bench and os.path.realpath(port.device) == real for port in find_ports())


def lasting_name(device: str) -> str:
    """The name under which a port comes back: a bench's as listed, else one that stays when a cable is unplugged.

    Its own where the system has no better.
    """
    if os.path.islink(device):
        return device  # somebody named it so, and a bench that is started anew has another name in the list
    real = os.path.realpath(device)
    bench = next((port.device for port in _benches() if os.path.realpath(port.device) == real), None)
    if bench is not None:
        return bench
    for folder in LASTING:
        for link in sorted(folder.iterdir()) if folder.is_dir() else ():
            if os.path.realpath(link) == real:
                return str(link)
    return device


def board_of(device: str) -> str | None:
    """mega or nano, if the port named `device` says so."""
    real = os.path.realpath(device)
    for port in find_ports():
        if port.device == device or os.path.realpath(port.device) == real:
            return port.board
    return None


def forget_dead_benches() -> None:
    """Remove the links that killed benches left."""
    for link in _links():
        if not _runs(link.name.partition("-")[2]):
            link.unlink(missing_ok=True)


def _benches() -> list[Port]:
    ports = []
    for link in _links():
        board, _, process = link.name.partition("-")
        # A killed bench leaves its link behind, and its pseudo-terminal may be somebody else's by now.
        if link.exists() and _runs(process):
            ports.append(Port(str(link), f"bench, simulated {BOARDS[board]}", board, bench=True, usb=False))
    return ports


def _links() -> list[Path]:
    """What benches left in the runtime folders: each a link to its port, named board-process, mega-4711."""
    found = [link for folder in private_runtime_directories() for link in sorted(folder.iterdir())]
    return [link for link in found if link.is_symlink() and link.name.partition("-")[0] in BOARDS]


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
