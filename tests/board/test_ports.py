"""Finding ports: benches by their links, boards by what USB says, and one choice or one sentence."""

from __future__ import annotations

import os
import subprocess
import sys
from pathlib import Path
from types import SimpleNamespace

import pytest
from serial.tools import list_ports

from greywhale.base.errors import UserError
from greywhale.base.runtime import VARIABLE, make_runtime_directory
from greywhale.protocol import ports
from greywhale.protocol.ports import Port


@pytest.fixture(autouse=True)
def _no_real_ports(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setenv(VARIABLE, str(tmp_path / "run"))
    monkeypatch.setattr(list_ports, "comports", list)


def usb(
    device: str, vid: int | None, pid: int | None, description: str | None = "what the system says"
) -> SimpleNamespace:
    return SimpleNamespace(device=device, vid=vid, pid=pid, description=description)


MEGA, BRIDGE, UNKNOWN = (0x2341, 0x0042), (0x1A86, 0x7523), (0x1234, 0x5678)
GPS = (0x1546, 0x01A8, "u-blox 7 - GPS/GNSS Receiver")
MODEM = (0x12D1, 0x1001, "HUAWEI Mobile")
PRINTER = (0x2C99, 0x0002, "Original Prusa i3 MK3")
NAMED_MODEM = (*UNKNOWN, "SuperLTE modem, control port")
NAMED_GPS = (0x067B, 0x2303, "BU-353 GPS receiver")
PICO = (0x2E8A, 0x000A, "Pico")
UNO = (0x2341, 0x0043)


def plug(monkeypatch: pytest.MonkeyPatch, *found: SimpleNamespace) -> None:
    class Sortable(SimpleNamespace):
        def __lt__(self, other: SimpleNamespace) -> bool:
            return bool(self.device < other.device)

    monkeypatch.setattr(list_ports, "comports", lambda: [Sortable(**vars(one)) for one in found])


def bench(name: str, target: str) -> Path:
    folder = make_runtime_directory()
    link = folder / name
    link.symlink_to(target)
    return link


def test_benches_are_found_by_their_links_and_dead_ones_are_not() -> None:
    link = bench(f"nano-{os.getpid()}", "/dev/null")
    bench(f"mega-{os.getpid()}", "/dev/nowhere")
    bench("something", "/dev/null")
    assert ports.find_ports() == [
        Port(str(link), "bench, simulated Arduino Nano (ATmega328P)", "nano", bench=True, usb=False)
    ]
    assert ports.board_of(str(link)) == ports.board_of("/dev/null") == "nano"
    assert ports.board_of("/dev/zero") is None


def test_the_link_of_a_killed_bench_may_lead_to_somebody_elses_terminal() -> None:
    killed = subprocess.Popen([sys.executable, "-c", ""])
    killed.wait()
    bench(f"nano-{killed.pid}", "/dev/null")
    bench("mega-no-number", "/dev/null")
    assert ports.find_ports() == []


def test_boards_are_known_by_their_usb_numbers(monkeypatch: pytest.MonkeyPatch) -> None:
    plug(
        monkeypatch,
        usb("/dev/ttyUSB0", 0x1A86, 0x7523),
        usb("/dev/ttyACM0", 0x2341, 0x0042),
        usb("/dev/ttyS0", None, None),
        usb("/dev/ttyACM1", 0x2341, 0x0058),
    )
    found = ports.find_ports()
    assert [(one.device, one.board, one.likely) for one in found] == [
        ("/dev/ttyACM0", "mega", True),
        ("/dev/ttyACM1", None, False),
        ("/dev/ttyS0", None, False),
        ("/dev/ttyUSB0", None, True),
    ]
    assert found[1].description == "Arduino Nano Every, which greywhale does not run on"
    assert "USB serial bridge" in found[3].description


def test_no_port_or_several_are_one_sentence(monkeypatch: pytest.MonkeyPatch) -> None:
    plug(monkeypatch, usb("/dev/ttyS0", None, None))
    with pytest.raises(UserError, match="no board was found.*greywhale sim.*--port") as caught:
        ports.choose_port(None)
    assert caught.value.exit_code == 2
    plug(monkeypatch, usb("/dev/ttyACM0", 0x2341, 0x0042), usb("/dev/ttyACM1", 0x2341, 0x0042))
    with pytest.raises(UserError, match="/dev/ttyACM0, /dev/ttyACM1; choose one with --port"):
        ports.choose_port(None)


@pytest.mark.parametrize(
    ("devices", "chosen"),
    [
        ([BRIDGE], 0),  # a clone of a board: it does not name itself
        ([UNKNOWN], 0),
        ([(None, None), MEGA], 1),
        ([MEGA, BRIDGE], 0),
        ([BRIDGE, MEGA, UNKNOWN], 1),
        ([UNKNOWN, BRIDGE], 1),
        ([GPS, BRIDGE], 1),
        ([MODEM, PRINTER, UNKNOWN], 2),
        ([NAMED_MODEM, NAMED_GPS, PICO, UNO, BRIDGE], 4),
    ],
)
def test_the_likeliest_port_is_chosen(
    devices: list[tuple[int | None, int | None]], chosen: int, monkeypatch: pytest.MonkeyPatch
) -> None:
    plug(monkeypatch, *(usb(f"/dev/ttyUSB{place}", *device) for place, device in enumerate(devices)))
    assert ports.choose_port(None) == f"/dev/ttyUSB{chosen}"


@pytest.mark.parametrize("device", [GPS, MODEM, PRINTER, NAMED_MODEM, NAMED_GPS, PICO, UNO])
def test_what_is_known_to_be_something_else_is_never_opened_by_itself(
    device: tuple[int, int], monkeypatch: pytest.MonkeyPatch
) -> None:
    plug(monkeypatch, usb("/dev/ttyACM0", *device))
    with pytest.raises(UserError, match=r"no board was found .*\(/dev/ttyACM0 is not opened: .*does not run on"):
        ports.choose_port(None)
    assert ports.choose_port("/dev/ttyACM0") == "/dev/ttyACM0", "whoever names it knows better"


@pytest.mark.parametrize("description", ["USB2.0-Serial", "FT232R USB UART", "CP2102 USB to UART Bridge", "", None])
def test_what_says_nothing_may_be_a_board(description: str | None, monkeypatch: pytest.MonkeyPatch) -> None:
    plug(monkeypatch, usb("/dev/ttyUSB0", *UNKNOWN, description))
    assert ports.choose_port(None) == "/dev/ttyUSB0"


@pytest.mark.parametrize(("device", "asks"), [(MEGA, True), (BRIDGE, True), (UNKNOWN, False), (GPS, False)])
def test_a_bench_gives_way_to_no_board_and_to_no_foreign_device(
    device: tuple[int, int], asks: bool, monkeypatch: pytest.MonkeyPatch
) -> None:
    link = bench(f"mega-{os.getpid()}", "/dev/null")
    plug(monkeypatch, usb("/dev/ttyUSB0", *device))
    if asks:
        with pytest.raises(UserError, match=rf"{link}, /dev/ttyUSB0; choose one with --port"):
            ports.choose_port(None)
    else:
        assert ports.choose_port(None) == str(link)
