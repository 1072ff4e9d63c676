"""The firmware on the simulated boards, read back through their real bootloaders by doctor."""

from __future__ import annotations

import contextlib
import json
from pathlib import Path
from typing import Any

import pytest

from greywhale.base.errors import UserError
from greywhale.board.device import Device
from greywhale.board.flash.pages import held_blocks
from greywhale.board.flash.readback import shipped_image
from greywhale.board.flash.rules import BOARDS
from greywhale.cli.entry import run
from greywhale.protocol.lines import open_line
from greywhale.protocol.schema import State
from greywhale.protocol.transport import LINES
from greywhale_sim.words import lock_step
from tests.board.flash.hex_files import hex_text


def doctor(port: str, capsys: pytest.CaptureFixture[str], *more: str) -> tuple[int, dict[str, dict[str, str]]]:
    """The exit code, and the findings by what was looked at."""
    code = run(["doctor", "--port", port, "--seconds", "0.5", "--json", "--image", *more])
    findings: list[dict[str, Any]] = json.loads(capsys.readouterr().out)["findings"]
    return code, {one["check"]: one for one in findings}


@pytest.mark.slow
@pytest.mark.parametrize(
    ("board", "verdict", "says"),
    [("mega", "good", "starts the firmware again"), ("nano", "note", "says nothing until")],
)
def test_the_image_is_read_back_a_wrong_byte_named_and_the_bootloader_looked_at(
    board: str, verdict: str, says: str, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    image = shipped_image(board)
    memory, held = bytearray(image.memory), sum(map(len, held_blocks(image, BOARDS[board].page)))
    with lock_step("--board", board) as bench:
        code, findings = doctor(bench.port, capsys)
        found = findings["image"]
        assert (code, found["verdict"]) == (0, "good"), found
        assert f"All {held:,} bytes" in found["says"]
        assert findings["bootloader"]["verdict"] == verdict
        assert says in findings["bootloader"]["says"]
        memory[0x1234] ^= 0xFF
        (tmp_path / "other.hex").write_text(hex_text(bytes(memory[:0x2000])))
        code, findings = doctor(bench.port, capsys, "--hex", str(tmp_path / "other.hex"))
        found = findings["image"]
        assert (code, found["verdict"]) == (1, "bad")
        assert "1 of" in found["says"]
        assert "the first at address 0x1234" in found["says"]
        with Device(bench.port, restart=False) as device:
            assert device.status().state is State.DISABLED, "its firmware runs again"


@pytest.mark.slow
def test_a_board_whose_motors_are_on_is_not_restarted(capsys: pytest.CaptureFixture[str]) -> None:
    with lock_step() as bench:
        line = open_line(bench.port)
        with pytest.MonkeyPatch.context() as dying:
            dying.setitem(LINES, bench.port, lambda restart, baud: line)
            with contextlib.suppress(UserError), Device(bench.port) as device:
                device.enable(0)
                dying.setattr(line, "write", lambda data: None)  # from now on nothing is said, not even a stop
        resets = bench.command("status")["resets"]
        code, findings = doctor(bench.port, capsys)
        assert (code, findings["image"]["verdict"]) == (1, "bad")
        assert "the motors are on" in findings["image"]["says"]
        after = bench.command("status")
        assert (after["motors_enabled"], after["resets"]) == (True, resets)


def test_a_file_without_image_is_bad_usage(capsys: pytest.CaptureFixture[str]) -> None:
    assert run(["doctor", "--hex", "some.hex"]) == 2
    assert "--hex belongs to --image" in capsys.readouterr().err
