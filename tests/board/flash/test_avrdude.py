"""avrdude is found where people have it, watched while it writes, and missed in one sentence."""

from __future__ import annotations

from pathlib import Path

import pytest

from greywhale.base.errors import UserError
from greywhale.base.types import show_no_progress
from greywhale.board.flash.avrdude import find_avrdude, need_avrdude, watch_upload


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
