"""avrdude and PlatformIO are found where people have them, run with what the project needs, missed in one sentence."""

from __future__ import annotations

import importlib.util
import sys
from pathlib import Path

import pytest

from greywhale.base.errors import UserError
from greywhale.base.types import show_no_progress
from greywhale.board.flash import platformio
from greywhale.board.flash.avrdude import find_avrdude, need_avrdude, watch_upload
from greywhale.board.flash.runner import Tool
from greywhale.board.flash.targets import BOARDS


def make(path: Path) -> Path:
    path.parent.mkdir(parents=True, exist_ok=True)
    path.write_text("#!/bin/sh\n")
    path.chmod(0o755)
    return path


@pytest.fixture
def home(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    """A home of a machine without avrdude."""
    monkeypatch.setenv("PATH", str(tmp_path / "bin"))
    monkeypatch.setenv("HOME", str(tmp_path))
    monkeypatch.delenv("PLATFORMIO_CORE_DIR", raising=False)
    return tmp_path


def test_without_avrdude_one_sentence_says_what_to_install(home: Path) -> None:
    assert find_avrdude() is None
    with pytest.raises(UserError, match="avrdude, which writes the firmware .* apt-get install avrdude"):
        need_avrdude()


def test_avrdude_is_found_on_the_path_first(home: Path) -> None:
    make(home / ".platformio/packages/tool-avrdude/avrdude")
    make(home / ".platformio/packages/tool-avrdude/avrdude.conf")
    program = make(home / "bin/avrdude")
    assert find_avrdude() == [str(program)]


@pytest.mark.parametrize("program", ["avrdude", "bin/avrdude"])
def test_avrdude_is_found_where_platformio_keeps_it(home: Path, monkeypatch: pytest.MonkeyPatch, program: str) -> None:
    core = home / "elsewhere"
    monkeypatch.setenv("PLATFORMIO_CORE_DIR", str(core))
    found = make(core / "packages/tool-avrdude" / program)
    assert find_avrdude() is None  # it would not find its own settings
    settings = make(core / "packages/tool-avrdude/avrdude.conf")
    assert find_avrdude() == [str(found), "-C", str(settings)]


def test_the_latest_avrdude_of_the_arduino_ide_is_found(home: Path) -> None:
    for version in ("6.3.0-arduino17", "8.0.0-arduino1"):
        make(home / f".arduino15/packages/arduino/tools/avrdude/{version}/bin/avrdude")
        make(home / f".arduino15/packages/arduino/tools/avrdude/{version}/etc/avrdude.conf")
    folder = home / ".arduino15/packages/arduino/tools/avrdude/8.0.0-arduino1"
    assert find_avrdude() == [str(folder / "bin/avrdude"), "-C", str(folder / "etc/avrdude.conf")]


def test_avrdudes_rows_become_fractions() -> None:
    seen: list[tuple[str, float]] = []
    look = watch_upload("COM3", lambda what, fraction: seen.append((what, fraction)))
    look("avrdude: writing flash\n\nWriting | #########################")
    look("Writing | ################################################## | 100% 1.2s\n\nReading | #####")
    assert seen == [("writing", 0.5), ("verifying", 0.1)], "one stage after the other"


def test_a_port_that_goes_away_ends_the_upload(tmp_path: Path) -> None:
    port = tmp_path / "port"
    port.touch()
    look = watch_upload(str(port), show_no_progress)
    look("Writing | ####")
    port.unlink()
    with pytest.raises(UserError, match="port went away while it was being flashed; connect the board"):
        look("Writing | ####")


@pytest.fixture
def tools(monkeypatch: pytest.MonkeyPatch) -> list[Tool]:
    """The tools that would have run."""
    told: list[Tool] = []
    monkeypatch.setattr(platformio, "run_tool", lambda tool, look: told.append(tool))
    return told


def test_the_projects_own_core_folder_is_used(tools: list[Tool], tmp_path: Path) -> None:
    firmware = tmp_path / "firmware"
    assembled = tmp_path / "build" / "platformio" / "assembled"
    assembled.parent.mkdir(parents=True)
    assembled.touch()
    built = platformio.build(firmware, BOARDS["nano"], show_no_progress)
    assert built == firmware / ".pio" / "build" / "nanoatmega328" / "firmware.hex"
    assert tools[0].environment["PLATFORMIO_CORE_DIR"] == str(assembled.parent)
    assert tools[0].environment["PLATFORMIO_SETTING_ENABLE_TELEMETRY"] == "no"
    command = [sys.executable, "-m", "platformio", "run", "--project-dir", str(firmware)]
    assert tools[0].command == [*command, "--environment", "nanoatmega328"]


def test_the_settings_of_the_current_folder_are_not_platformios(
    tools: list[Tool], tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    """It obeys a platformio.ini of the folder that it runs in, so it runs in the firmware's."""
    monkeypatch.chdir(tmp_path)
    Path("port").touch()
    firmware = Path("firmware")
    platformio.build(firmware, BOARDS["mega"], show_no_progress)
    platformio.upload(firmware, BOARDS["mega"], "port", show_no_progress)
    for tool in tools:
        assert tool.folder == firmware
        assert tool.command[tool.command.index("--project-dir") + 1] == str(tmp_path / "firmware")
    assert tools[1].port == str(tmp_path / "port")
    assert tools[1].port in tools[1].command


def test_a_build_folder_that_was_moved_is_found(
    tools: list[Tool], tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setenv("PLATFORMIO_BUILD_DIR", str(tmp_path / "there"))
    built = platformio.build(tmp_path, BOARDS["mega"], show_no_progress)
    assert built == tmp_path / "there" / "megaatmega2560" / "firmware.hex"


def test_without_platformio_one_sentence_says_what_to_install(
    tools: list[Tool], tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(importlib.util, "find_spec", lambda name: None)
    monkeypatch.setenv("PATH", str(tmp_path))
    with pytest.raises(UserError, match=r"PlatformIO, .* is not installed; run `pip install 'greywhale\[build\]'`"):
        platformio.build(tmp_path, BOARDS["mega"], show_no_progress)
    program = tmp_path / "platformio"
    program.write_text("#!/bin/sh\n")
    program.chmod(0o755)
    platformio.build(tmp_path, BOARDS["mega"], show_no_progress)
    assert tools[0].command[0] == str(program)
