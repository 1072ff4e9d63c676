"""PlatformIO is found where people have it, run with what the project needs, and missed in one sentence."""

from __future__ import annotations

import importlib.util
import sys
from pathlib import Path

import pytest

from greywhale.base.errors import UserError
from greywhale.base.types import show_no_progress
from greywhale.board.flash import platformio
from greywhale.board.flash.runner import Tool
from greywhale.board.flash.targets import BOARDS


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
    firmware = Path("firmware")
    platformio.build(firmware, BOARDS["mega"], show_no_progress)
    assert tools[0].folder == firmware
    assert tools[0].command[tools[0].command.index("--project-dir") + 1] == str(tmp_path / "firmware")


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
