"""Flashing a board whose bootloader and firmware are in this process: what is written when, and what people are told.
Real firmware goes onto the simulated board in the end-to-end tests."""

from __future__ import annotations

from collections.abc import Iterator
from pathlib import Path

import pytest

from greywhale.base.errors import UserError
from greywhale.board import meeting
from greywhale.board.device import Device
from greywhale.board.flash import flasher as module
from greywhale.board.flash import images, platformio
from greywhale.board.flash.bootloader import find_bootloader
from greywhale.board.flash.images import read_image
from greywhale.board.flash.rules import BOARDS
from greywhale.board.flash.runner import Tool
from greywhale.protocol import schema
from greywhale.protocol.transport import BAUD, LINES, Line
from tests.board.fake_board import FakeBoard
from tests.board.flash.fake_bootloader import ATMEGA328P, MEGA2560, FakeBootloader, Version1, Version2
from tests.board.flash.hex_files import write_image
from tests.board.port_board import PortBoard

MEGA = BOARDS["mega"]


@pytest.fixture(autouse=True)
def quick_device(monkeypatch: pytest.MonkeyPatch) -> None:
    """A device that does not wait for a bootloader."""
    monkeypatch.setattr(module, "Device", lambda port: Device(port, quiet_s=0.0, patience_s=0.5))


def put_before(firmware: FakeBoard, bootloader: FakeBootloader, monkeypatch: pytest.MonkeyPatch) -> str:
    """The port of a Mega that has this bootloader and this firmware."""
    start = LINES[firmware.port]

    def open_either(restart: bool, baud: int) -> Line:
        return start(restart, baud) if baud == BAUD else bootloader.open(restart, baud)

    monkeypatch.setitem(LINES, firmware.port, open_either)
    return firmware.port


@pytest.fixture
def bootloader() -> Version2:
    return Version2(115200, MEGA2560)


@pytest.fixture
def port(bootloader: Version2, monkeypatch: pytest.MonkeyPatch) -> Iterator[str]:
    with FakeBoard() as firmware:
        yield put_before(firmware, bootloader, monkeypatch)


def holds(bootloader: FakeBootloader, image: Path) -> bool:
    content = read_image(image).memory
    return bootloader.memory[: len(content)] == content


def test_a_port_that_is_not_there_or_in_use_is_named(tmp_path: Path) -> None:
    image = write_image(tmp_path / "x.hex")
    with pytest.raises(UserError, match="there is no such port"):
        module.flash(str(tmp_path / "ttyNONE"), "mega", hex_file=image)
    with PortBoard() as board, Device(board.port, 0.0, 0.5), pytest.raises(UserError, match="in use by this program"):
        module.flash(board.port, "mega", hex_file=image)


def test_nobody_gets_the_port_between_two_openings(
    bootloader: Version2, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    held: list[bool] = []

    def look(what: str, fraction: float) -> None:
        found = meeting.find(board.port, 0.0)
        held.append(found is not None)
        if found is not None:
            found[0].close()

    with PortBoard() as board:
        monkeypatch.setattr(module, "find_bootloader", lambda port, *likely: find_bootloader(bootloader.port, *likely))
        monkeypatch.setattr(module, "write_image", lambda *_: None)
        with bootloader:
            module.flash(board.port, "mega", hex_file=write_image(tmp_path / "firmware.hex"), report=look)
        assert set(held) == {True}
        assert meeting.find(board.port, 0.0) is None


def test_missing_sources_and_files_are_bad_usage(tmp_path: Path) -> None:
    with pytest.raises(UserError, match=r"no platformio\.ini") as caught:
        module.flash("/dev/null", "mega", firmware_dir=tmp_path)
    assert caught.value.exit_code == 2
    with pytest.raises(UserError, match=r"x\.hex: there is no such file") as caught:
        module.flash("/dev/null", "mega", hex_file=tmp_path / "x.hex")
    assert caught.value.exit_code == 2
    with pytest.raises(UserError, match="'uno' .* mega, nano"):
        module.flash("/dev/null", "uno")


def test_an_image_is_written_stage_by_stage_and_the_firmware_is_greeted(
    bootloader: Version2, port: str, tmp_path: Path
) -> None:
    image, stages = write_image(tmp_path / "firmware.hex", MEGA.signature), list[str]()
    hello = module.flash(port, "mega", hex_file=image, report=lambda what, fraction: stages.append(what))
    assert hello.board is schema.Board.MEGA2560
    assert holds(bootloader, image)
    assert list(dict.fromkeys(stages)) == [
        "looking for the bootloader",
        "writing",
        "verifying",
        "greeting the firmware",
    ]


@pytest.mark.parametrize(
    ("kind", "named", "words"),
    [
        (Version2, "nano", "of an Arduino Mega 2560 answers, .*--board mega"),
        (Version1, "mega", "of an Arduino Nano .* answers, .*--board nano"),
    ],
    ids=["a Mega", "a Nano"],
)
def test_a_board_that_is_named_wrongly_is_recognised_by_its_bootloader(
    kind: type[FakeBootloader], named: str, words: str, tmp_path: Path
) -> None:
    image = write_image(tmp_path / "firmware.hex", BOARDS[named].signature)
    signature = MEGA2560 if kind is Version2 else ATMEGA328P
    with kind(115200, signature) as line, pytest.raises(UserError, match=words) as caught:
        module.flash(line.port, named, hex_file=image)
    assert caught.value.exit_code == 2
    assert not line.asked["write"]


def test_a_board_that_is_named_wrongly_is_recognised_by_its_port_and_its_firmware(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    image = write_image(tmp_path / "firmware.hex")
    with FakeBoard() as firmware, pytest.raises(UserError, match="flashed for nano, .* for Arduino Mega 2560"):
        module.flash(put_before(firmware, Version1(57600, ATMEGA328P), monkeypatch), "nano", hex_file=image)
    monkeypatch.setattr(module, "board_of", lambda port: "mega")
    with pytest.raises(UserError, match="^/dev/ttyACM0: .*Arduino Mega 2560, not .* an Arduino Nano"):
        module.flash("/dev/ttyACM0", "nano")


@pytest.mark.parametrize(
    ("signature", "size", "words"),
    [
        (ATMEGA328P, 600, "for an Arduino Nano"),
        (b"\x1e\x97\x03", 600, "1e9703"),
        (None, MEGA.space + 1, "reaches up to byte 253953"),
    ],
    ids=["of the other board", "of another one", "over the bootloader"],
)
def test_a_board_gets_no_image_that_is_not_for_it(
    bootloader: Version2, port: str, tmp_path: Path, signature: bytes | None, size: int, words: str
) -> None:
    image = write_image(tmp_path / "firmware.hex", signature, size)
    with pytest.raises(UserError, match=words) as caught:
        module.flash(port, hex_file=image)
    assert caught.value.exit_code == 2
    assert not bootloader.asked["write"]


def test_a_chip_that_greywhale_does_not_know_is_refused(tmp_path: Path) -> None:
    # an old Mega (ATmega1280) speaks as a Nano does
    image = write_image(tmp_path / "firmware.hex")
    with Version1(57600, b"\x1e\x97\x03") as line, pytest.raises(UserError, match="the chip has signature 1e9703"):
        module.flash(line.port, "nano", hex_file=image)
    assert not line.asked["write"]


def test_an_installed_package_writes_the_image_that_came_with_it(
    bootloader: Version2, port: str, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(platformio, "CHECKOUT", tmp_path / "nowhere")
    monkeypatch.setattr(images, "PACKAGED", tmp_path)
    with pytest.raises(UserError, match="no firmware for an Arduino Mega 2560"):
        module.flash(port)
    image = write_image(tmp_path / "mega.hex", MEGA.signature)
    module.flash(port)
    assert holds(bootloader, image)


def test_a_checkout_writes_its_last_build_while_that_is_of_its_sources(
    bootloader: Version2, port: str, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    (tmp_path / "platformio.ini").write_text("")
    last, new = (write_image(tmp_path / name, MEGA.signature, size) for name, size in (("last", 600), ("new", 700)))
    current = [read_image(last), None]
    monkeypatch.setattr(platformio, "CHECKOUT", tmp_path)
    monkeypatch.setattr(platformio, "current_build", lambda firmware, board: current.pop(0))
    monkeypatch.setattr(platformio, "build", lambda firmware, board, report: new)
    for image in (last, new):
        module.flash(port, "mega")
        assert holds(bootloader, image)
    module.flash(port, "mega", firmware_dir=tmp_path)
    assert holds(bootloader, new), "a folder that is named is built"


@pytest.mark.parametrize("baud", [115200, 57600])
def test_platformio_builds_and_does_not_upload(baud: int, tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    (tmp_path / "platformio.ini").write_text("")
    (folder := tmp_path / ".pio" / "build" / "nanoatmega328").mkdir(parents=True)
    bootloader, commands = Version1(baud, ATMEGA328P), list[list[str]]()

    def build(tool: Tool, look: object) -> None:
        assert not bootloader.asked["write"], "nothing is erased before there is something to write"
        commands.append(tool.command[3:])
        write_image(folder / "firmware.hex", ATMEGA328P)

    monkeypatch.setattr(platformio, "run_tool", build)
    with FakeBoard() as firmware, pytest.raises(UserError, match="flashed for nano"):
        module.flash(put_before(firmware, bootloader, monkeypatch), "nano", firmware_dir=tmp_path)
    assert commands == [["run", "--project-dir", str(tmp_path), "--environment", "nanoatmega328"]]
    assert holds(bootloader, folder / "firmware.hex")
