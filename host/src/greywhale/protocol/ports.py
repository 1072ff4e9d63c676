"""Finds serial ports, boards on USB and running benches, without opening any; the port's own data tell them apart."""

from __future__ import annotations

import os
import re
from dataclasses import dataclass
from pathlib import Path
from typing import TypedDict

from serial.tools import list_ports
from serial.tools.list_ports_common import ListPortInfo

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
_NO_FIRMWARE = "which greywhale does not run on"
# Other boards, by vendor and product.
_OTHER_BOARDS = {
    (0x2341, 0x0001): "Arduino Uno",
    (0x2341, 0x0043): "Arduino Uno",
    (0x2A03, 0x0043): "Arduino Uno",
    (0x2341, 0x0243): "Arduino Uno",
    (0x2341, 0x0058): "Arduino Nano Every",
    (0x2341, 0x0069): "Arduino Uno R4",
    (0x2341, 0x1002): "Arduino Uno R4",
    (0x2341, 0x003D): "Arduino Due",
    (0x2341, 0x003E): "Arduino Due",
    (0x2341, 0x8036): "Arduino Leonardo",
    (0x2341, 0x8037): "Arduino Micro",
    (0x16C0, 0x0483): "a Teensy",
    (0x1D50, 0x6029): "a 3D printer with Marlin",
    (0x1D50, 0x614E): "a 3D printer with Klipper",
}
# Vendors none of whose devices is a board for greywhale.
_OTHER_VENDORS = {
    0x0483: "a board or probe with an STM32",
    0x1366: "a J-Link probe",
    0x239A: "an Adafruit board",
    0x2E8A: "a Raspberry Pi Pico",
    0x303A: "a board with an ESP32",
    0x1546: "a u-blox GPS receiver",
    0x091E: "a Garmin GPS receiver",
    0x2C99: "a Prusa 3D printer",
    0x12D1: "a Huawei modem",
    0x1199: "a Sierra modem",
    0x19D2: "a ZTE modem",
    0x1BC7: "a Telit modem",
    0x1E0E: "a SIMCom modem",
    0x2C7C: "a Quectel modem",
}
# What a device that is no board calls itself.
_OTHER_WORDS = re.compile(
    r"\b(GPS|GNSS|modem|LTE|3D[- ]printer|printer|Prusa|Marlin|Klipper|ESP32\w*|STLINK|ST-Link|J-Link|scanner)\b", re.I
)
# Linux names ports in these folders by their device's own number, or by the socket that it is plugged into.
LASTING = (Path("/dev/serial/by-id"), Path("/dev/serial/by-path"))
_NOT_IN_LABELS = re.compile(r"[^0-9A-Za-z]+")
MOST_LABEL = 120  # letters of a folder's name: systems take 255 bytes
_BRIDGES = {0x1A86, 0x0403, 0x10C4, 0x067B}


class PortFacts(TypedDict):
    port: str
    description: str
    board: str | None  # mega or nano, where the port tells
    bench: bool  # whether it is a simulated board


@dataclass(frozen=True)
class Port:
    """One serial port; `board` is mega, nano or None where the port does not say; `bench` marks a simulated board.

    `bridge` marks a USB bridge as boards' clones have it, `other` a device that is known to be something else.
    """

    device: str
    description: str
    board: str | None
    bench: bool
    usb: bool
    bridge: bool = False
    other: bool = False

    @property
    def likely(self) -> bool:
        """True if a greywhale board may be behind it."""
        return self.bench or (self.usb and not self.other)

    def as_dict(self) -> PortFacts:
        return {"port": self.device, "description": self.description, "board": self.board, "bench": self.bench}


def find_ports() -> list[Port]:
    """List benches first, then every serial port of this machine."""
    return _benches() + _hardware()


def choose_port(named: str | None) -> str:
    """The port to use: the one named, or else the only one behind which a board is, or most likely is.

    What is known to be another device is never chosen: to open its port may restart it.
    """
    if named is not None:
        return named
    found = find_ports()
    likely = _most_likely(found)
    if len(likely) == 1:
        return likely[0].device
    if not likely:
        others = "".join(f" ({port.device} is not opened: {port.description})" for port in found if port.other)
        raise BadUsage(
            f"no board was found on any serial port{others}; plug it in, start a simulated one with `greywhale sim`, "
            "or name its port with --port."
        )
    names = ", ".join(port.device for port in likely)
    raise BadUsage(f"several ports may be the board: {names}; choose one with --port.")


def _most_likely(found: list[Port]) -> list[Port]:
    """Benches; and boards that name themselves, else bridges, else, without a bench, whatever may be a board.

    A bench gives no way to a bridge, nor a bridge to a bench: somebody may have forgotten either.
    """
    benches = [port for port in found if port.bench]
    plugged = [port for port in found if port.likely and not port.bench]
    named, bridges = [port for port in plugged if port.board], [port for port in plugged if port.bridge]
    return benches + (named or bridges or ([] if benches else plugged))


def is_bench(device: str) -> bool:
    """True if the port named `device` is a simulated board's."""
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


def lasting_label(device: str) -> str:
    """A word for the board at a port, fit for a folder's name: its USB serial number, where it has one; else the socket
    that it is plugged into. All simulated boards are `bench`.
    """
    if is_bench(device):
        return "bench"
    real = os.path.realpath(device)
    found = next((one for one in list_ports.comports() if os.path.realpath(one.device) == real), None)
    if found is not None and found.serial_number:
        return _NOT_IN_LABELS.sub("-", f"usb-{found.vid:04x}-{found.pid:04x}-{found.serial_number}")[:MOST_LABEL]
    return _NOT_IN_LABELS.sub("-", lasting_name(device)).strip("-")[-MOST_LABEL:]


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
    """The links that benches left in the runtime folders: each to its port, named board-process, mega-4711."""
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
    return [_port(found) for found in sorted(list_ports.comports())]


def _port(found: ListPortInfo) -> Port:
    board = _KNOWN.get((found.vid or 0, found.pid or 0))
    other = None if board else _something_else(found)
    bridge = not (board or other) and found.vid in _BRIDGES
    description = BOARDS[board] if board else other or found.description or "serial port"
    if bridge:
        description = f"USB serial bridge, as many Arduino boards have ({found.description})"
    usb = found.vid is not None
    return Port(found.device, description, board, bench=False, usb=usb, bridge=bridge, other=other is not None)


def _something_else(found: ListPortInfo) -> str | None:
    """The nature of a device that is certainly no board for greywhale; None where it may be one."""
    if board := _OTHER_BOARDS.get((found.vid or 0, found.pid or 0)):
        return f"{board}, {_NO_FIRMWARE}"
    if vendor := _OTHER_VENDORS.get(found.vid or 0):
        return f"{vendor}, {_NO_FIRMWARE} ({found.description})"
    return f"{found.description}, {_NO_FIRMWARE}" if _OTHER_WORDS.search(found.description or "") else None
