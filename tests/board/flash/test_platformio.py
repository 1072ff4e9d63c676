"""PlatformIO is found where people have it, run with what the project needs, and missed in one sentence; a build of the
same sources needs it no more.
"""

from __future__ import annotations

import importlib.util
import os
import sys
from pathlib import Path

import pytest

from greywhale.base.errors import UserError
from greywhale.base.types import show_no_progress
from greywhale.board.flash import platformio
from greywhale.board.flash.rules import BOARDS
from greywhale.board.flash.runner import Tool
from tests.board.flash.hex_files import SOURCES, write_image

MEGA = BOARDS["mega"]


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
    platformio.build(firmware, MEGA, show_no_progress)
    assert tools[0].folder == firmware
    assert tools[0].command[tools[0].command.index("--project-dir") + 1] == str(tmp_path / "firmware")


def test_a_build_folder_that_was_moved_is_found(
    tools: list[Tool], tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setenv("PLATFORMIO_BUILD_DIR", str(tmp_path / "there"))
    built = platformio.build(tmp_path, MEGA, show_no_progress)
    assert built == tmp_path / "there" / "megaatmega2560" / "firmware.hex"


def test_without_platformio_one_sentence_says_what_to_install(
    tools: list[Tool], tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(importlib.util, "find_spec", lambda name: None)
    monkeypatch.setenv("PATH", str(tmp_path))
    with pytest.raises(UserError, match=r"PlatformIO, .* is not installed; run `pip install 'greywhale\[build\]'`"):
        platformio.build(tmp_path, MEGA, show_no_progress)
    program = tmp_path / "platformio"
    program.write_text("#!/bin/sh\n")
    program.chmod(0o755)
    platformio.build(tmp_path, MEGA, show_no_progress)
    assert tools[0].command[0] == str(program)


@pytest.fixture
def built(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    """The last build for a Mega, of the sources in this folder."""
    for name in [name for name in os.environ if name.startswith("PLATFORMIO_")]:
        monkeypatch.delenv(name)
    put_digest(tmp_path, SOURCES)
    path = tmp_path / ".pio" / "build" / "megaatmega2560" / "firmware.hex"
    path.parent.mkdir(parents=True)
    return write_image(path, MEGA.signature)


def put_digest(firmware: Path, digest: str) -> None:
    (firmware / "source_digest.py").write_text(f"def source_digest(firmware):\n    return {digest!r}\n")


def test_a_build_of_these_sources_is_taken_as_it_is(built: Path, tmp_path: Path) -> None:
    image = platformio.current_build(tmp_path, MEGA)
    assert image is not None
    assert (image.path, image.end) == (built, 600)


def test_a_build_that_may_not_be_of_these_sources_is_not_taken(
    built: Path, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    assert platformio.current_build(tmp_path, BOARDS["nano"]) is None, "never built"
    with monkeypatch.context() as settings:
        settings.setenv("PLATFORMIO_BUILD_FLAGS", "-O3")
        assert platformio.current_build(tmp_path, MEGA) is None, "built with other settings"
    put_digest(tmp_path, "fedcba9876543210")
    assert platformio.current_build(tmp_path, MEGA) is None, "built from other sources"
    put_digest(tmp_path, SOURCES)
    write_image(built)
    assert platformio.current_build(tmp_path, MEGA) is None, "says nothing of its sources"
    built.write_text(write_image(built, MEGA.signature).read_text()[:-20])
    assert platformio.current_build(tmp_path, MEGA) is None, "cut off"
