"""Flashing with tools that are scripts: what is run with what, and what people are told. The real tools flash the
simulated board in the end-to-end tests."""

from __future__ import annotations

import os
import sys
from pathlib import Path

import pytest

from greywhale.base.errors import UserError
from greywhale.board import meeting
from greywhale.board.device import Device
from greywhale.board.flash import flasher as module
from greywhale.board.flash import images, platformio
from greywhale.board.flash.bootloader import Bootloader, Dialect
from greywhale.board.flash.targets import BOARDS
from greywhale.protocol import schema
from tests.board.fake_board import FakeBoard
from tests.board.flash.fake_bootloader import ATMEGA328P, MEGA2560, FakeBootloader, Version1, Version2
from tests.board.flash.hex_files import write_image
from tests.board.port_board import PortBoard

MEGA = BOARDS["mega"]


@pytest.fixture
def told(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    """The file into which an avrdude that does nothing writes what it was told."""
    folder = tmp_path / "bin"
    folder.mkdir()
    path = folder / "avrdude"
    path.write_text(
        f"#!{sys.executable}\nimport sys\nopen({str(tmp_path / 'told')!r}, 'a').write(' '.join(sys.argv[1:]))\n"
    )
    path.chmod(0o755)
    monkeypatch.setenv("PATH", str(folder), prepend=os.pathsep)
    return tmp_path / "told"


@pytest.fixture
def quick_device(monkeypatch: pytest.MonkeyPatch) -> None:
    """A device that does not wait for a bootloader."""
    monkeypatch.setattr(module, "Device", lambda port: Device(port, quiet_s=0.0, patience_s=0.5))


def answering(monkeypatch: pytest.MonkeyPatch, programmer: str, baud: int, signature: bytes | None) -> None:
    """Let this bootloader answer; the board in Python has none."""
    found = Bootloader(Dialect(programmer, baud), signature)
    monkeypatch.setattr(module, "find_bootloader", lambda port, likely, others: found)


def test_a_port_that_is_not_there_or_in_use_stops_before_any_tool(told: Path, tmp_path: Path) -> None:
    """avrdude would wait for it for ever, or reset a board that runs its motors."""
    image = write_image(tmp_path / "x.hex")
    with pytest.raises(UserError, match="there is no such port"):
        module.flash(str(tmp_path / "ttyNONE"), "mega", hex_file=image)
    with PortBoard() as board, Device(board.port, 0.0, 0.5), pytest.raises(UserError, match="in use by this program"):
        module.flash(board.port, "mega", hex_file=image)
    assert not told.exists()


@pytest.mark.usefixtures("quick_device")
def test_nobody_gets_the_port_while_avrdude_has_it(told: Path, tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """avrdude locks nothing, and this process has the port closed meanwhile."""
    image = write_image(tmp_path / "firmware.hex", MEGA.signature)
    answering(monkeypatch, "wiring", 115200, MEGA2560)
    held: list[bool] = []

    def upload(port: str, *_: object) -> None:
        found = meeting.find(port, 0.0)
        held.append(found is not None)
        if found is not None:
            found[0].close()

    monkeypatch.setattr(module, "upload_image", upload)
    with PortBoard() as board:
        module.flash(board.port, "mega", hex_file=image)
        assert held == [True]
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


@pytest.mark.usefixtures("quick_device")
def test_avrdude_gets_the_boards_own_settings_and_the_firmware_is_greeted(
    told: Path, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    image = write_image(tmp_path / "firmware.hex", MEGA.signature)
    answering(monkeypatch, "wiring", 115200, MEGA2560)
    with FakeBoard() as board:
        hello = module.flash(board.port, "mega", hex_file=image)
        assert told.read_text() == f"-c wiring -p atmega2560 -P {board.port} -D -U flash:w:{image}:i -b 115200"
    assert hello.board is schema.Board.MEGA2560


@pytest.mark.parametrize(
    ("bootloader", "named", "words"),
    [
        (Version2, "nano", "of an Arduino Mega 2560 answers, .*--board mega"),
        (Version1, "mega", "of an Arduino Nano .* answers, .*--board nano"),
    ],
    ids=["a Mega", "a Nano"],
)
def test_a_board_that_is_named_wrongly_is_recognised_by_its_bootloader(
    bootloader: type[FakeBootloader], named: str, words: str, told: Path, tmp_path: Path
) -> None:
    image = write_image(tmp_path / "firmware.hex", BOARDS[named].signature)
    signature = MEGA2560 if bootloader is Version2 else ATMEGA328P
    with bootloader(115200, signature) as line, pytest.raises(UserError, match=words) as caught:
        module.flash(line.port, named, hex_file=image)
    assert caught.value.exit_code == 2
    assert not told.exists()


@pytest.mark.usefixtures("quick_device")
def test_a_board_that_is_named_wrongly_is_recognised_by_its_port_and_its_firmware(
    told: Path, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    answering(monkeypatch, "arduino", 57600, None)
    with FakeBoard() as board, pytest.raises(UserError, match="flashed for nano, .* for Arduino Mega 2560"):
        module.flash(board.port, "nano", hex_file=write_image(tmp_path / "firmware.hex"))
    monkeypatch.setattr(module, "board_of", lambda port: "mega")
    with pytest.raises(UserError, match="^/dev/ttyACM0: .*Arduino Mega 2560, not .* an Arduino Nano"):
        module.flash("/dev/ttyACM0", "nano")


def test_a_board_that_nobody_names_is_asked_and_gets_no_image_of_the_other(told: Path, tmp_path: Path) -> None:
    image = write_image(tmp_path / "firmware.hex", ATMEGA328P)
    with Version2(115200, MEGA2560) as line, pytest.raises(UserError, match="for an Arduino"):
        module.flash(line.port, hex_file=image)
    assert not told.exists()


def test_a_chip_that_greywhale_does_not_know_is_refused(told: Path, tmp_path: Path) -> None:
    # an old Mega (ATmega1280) speaks as a Nano does
    image = write_image(tmp_path / "firmware.hex")
    with Version1(57600, b"\x1e\x97\x03") as line, pytest.raises(UserError, match="the chip has signature 1e9703"):
        module.flash(line.port, "nano", hex_file=image)
    assert not told.exists()


@pytest.mark.usefixtures("quick_device")
def test_an_installed_package_writes_the_image_that_came_with_it(
    told: Path, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(platformio, "CHECKOUT", tmp_path / "nowhere")
    monkeypatch.setattr(images, "PACKAGED", tmp_path)
    answering(monkeypatch, "wiring", 115200, MEGA2560)
    with FakeBoard() as board:
        with pytest.raises(UserError, match="no firmware for an Arduino Mega 2560"):
            module.flash(board.port)
        image = write_image(tmp_path / "mega.hex", MEGA.signature)
        module.flash(board.port)
        assert f"flash:w:{image}:i" in told.read_text()


@pytest.mark.usefixtures("quick_device")
def test_platformio_builds_first_and_then_uploads(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    commands = commands_of(tmp_path, monkeypatch)
    (folder := tmp_path / ".pio" / "build" / "megaatmega2560").mkdir(parents=True)
    write_image(folder / "firmware.hex")
    answering(monkeypatch, "wiring", 115200, MEGA2560)
    with FakeBoard() as board:
        module.flash(board.port, "mega", firmware_dir=tmp_path)
        port = board.port
    build = ["run", "--project-dir", str(tmp_path), "--environment", "megaatmega2560"]
    assert commands == [build, [*build, "--target", "upload", "--upload-port", port]]


def test_what_platformio_builds_for_a_nano_goes_through_avrdude_at_the_speed_that_was_found(
    told: Path, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(module, "Device", lambda port: pytest.fail("greeted"))
    commands = commands_of(tmp_path, monkeypatch)
    with Version1(57600, ATMEGA328P) as line, pytest.raises(pytest.fail.Exception, match="greeted"):
        module.flash(line.port, "nano", firmware_dir=tmp_path)
    assert commands == [["run", "--project-dir", str(tmp_path), "--environment", "nanoatmega328"]]
    built = tmp_path / ".pio" / "build" / "nanoatmega328" / "firmware.hex"
    assert told.read_text() == f"-c arduino -p atmega328p -P {line.port} -D -U flash:w:{built}:i -b 57600"


def commands_of(folder: Path, monkeypatch: pytest.MonkeyPatch) -> list[list[str]]:
    """What a PlatformIO that does nothing is told where a firmware's sources are."""
    (folder / "platformio.ini").write_text("")
    commands: list[list[str]] = []
    monkeypatch.setattr(platformio, "run_tool", lambda tool, look: commands.append(tool.command[3:]))
    return commands
