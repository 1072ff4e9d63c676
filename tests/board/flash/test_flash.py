"""Flashing with tools that are scripts: what is run with what, and what people are told. The real tools flash the
simulated board in the end-to-end tests."""

from __future__ import annotations

import os
import select
import signal
import subprocess
import sys
import termios
import threading
import tty
from collections.abc import Callable
from pathlib import Path
from typing import Self

import pytest

from greywhale.board.device import Device
from greywhale.board.flash import flasher as module
from greywhale.board.flash.bootloader import find_speed
from greywhale.board.flash.runner import Tool, run_tool
from greywhale.errors import UserError
from greywhale.protocol import schema
from tests.board.fake_board import FakeBoard


def script(folder: Path, name: str, body: str) -> Path:
    """An executable Python script."""
    path = folder / name
    path.write_text(f"#!{sys.executable}\nimport os, sys\nhere = {str(folder)!r}\n{body}\n")
    path.chmod(0o755)
    return path


def tool(*command: str, limit_s: float = 60.0) -> Tool:
    return Tool("the tool", list(command), dict(os.environ), limit_s)


@pytest.fixture
def quick_device(monkeypatch: pytest.MonkeyPatch) -> None:
    """A device that does not wait for a bootloader."""
    monkeypatch.setattr(module, "Device", lambda port: Device(port, quiet_s=0.0, patience_s=0.5))


@pytest.fixture
def image(tmp_path: Path) -> Path:
    path = tmp_path / "firmware.hex"
    path.write_text(":00000001FF\n")
    return path


def test_output_is_watched_and_returned() -> None:
    seen: list[str] = []
    text = run_tool(tool(sys.executable, "-c", "print('\\x1b[32mone\\x1b[0m'); print('two')"), seen.append)
    assert text == "one\ntwo\n"
    assert seen


@pytest.mark.parametrize(
    ("output", "words"),
    [
        ("compiling\\nmain.cpp:3: error: no such thing\\n*** failed", "main.cpp:3: error: no such thing"),
        ("one\\nlast words", "last words"),
        ("", "it said nothing"),
        ("OS error: ioctl(TIOCMGET): Inappropriate ioctl for device", "it said nothing"),
        (
            "avrdude OS error: ioctl(TIOCMGET): Inappropriate ioctl for device\\n"
            "avrdude error: timeout communicating with programmer\\navrdude done.  Thank you.",
            "avrdude error: timeout communicating with programmer; no bootloader answered: check --board and the "
            "cable, press the board's reset button and try again.",
        ),
    ],
)
def test_a_failed_tool_is_quoted_where_it_names_the_problem(output: str, words: str) -> None:
    with pytest.raises(UserError) as caught:
        run_tool(tool(sys.executable, "-c", f"print('{output}'); raise SystemExit(3)"), lambda text: None)
    assert caught.value.message == f"the tool failed with exit code 3: {words}"


def test_a_tool_that_is_not_there_is_named() -> None:
    with pytest.raises(UserError, match="the tool cannot be started: No such file"):
        run_tool(tool("/nowhere/tool"), lambda text: None)


@pytest.fixture
def started(monkeypatch: pytest.MonkeyPatch) -> list[subprocess.Popen[bytes]]:
    """Every process that is started from now on."""
    processes: list[subprocess.Popen[bytes]] = []
    real = subprocess.Popen

    def start(*args: object, **options: object) -> subprocess.Popen[bytes]:
        processes.append(real(*args, **options))  # type: ignore[call-overload]
        return processes[-1]

    monkeypatch.setattr(subprocess, "Popen", start)
    return processes


def test_a_tool_that_hangs_is_ended(started: list[subprocess.Popen[bytes]]) -> None:
    with pytest.raises(UserError, match=r"has not ended after 0\.3 s; reset the board"):
        run_tool(
            tool(sys.executable, "-c", "import threading; threading.Event().wait()", limit_s=0.3), lambda text: None
        )
    assert started[0].returncode == -signal.SIGTERM


def test_what_the_tool_started_ends_with_it() -> None:
    started: list[int] = []

    def interrupt(text: str) -> None:
        if text.endswith("\n"):
            started.append(os.pidfd_open(int(text)))
            raise KeyboardInterrupt

    with pytest.raises(KeyboardInterrupt):
        run_tool(tool("sh", "-c", "trap '' TERM; sleep 1000 & echo $!; wait"), interrupt)
    try:
        assert select.select(started, [], [], 10.0)[0] == started  # readable once the process has ended
    finally:
        os.close(started[0])


def test_ctrl_c_ends_the_tool_too(started: list[subprocess.Popen[bytes]]) -> None:
    def interrupt(text: str) -> None:
        raise KeyboardInterrupt

    with pytest.raises(KeyboardInterrupt):
        run_tool(tool(sys.executable, "-c", "import threading; threading.Event().wait()"), interrupt)
    assert started[0].returncode == -signal.SIGTERM


def test_a_port_that_is_not_there_stops_before_any_tool(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    # avrdude would wait for it for ever
    monkeypatch.setattr(module, "run_tool", lambda *args: pytest.fail("a tool was started"))
    with pytest.raises(UserError, match="there is no such port"):
        module.flash(str(tmp_path / "ttyNONE"), "mega", hex_file=tmp_path / "x.hex")


def test_a_port_in_use_stops_before_any_tool(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    # avrdude would break into it, and reset a board that runs its motors
    monkeypatch.setattr(module, "run_tool", lambda *args: pytest.fail("a tool was started"))
    image = tmp_path / "firmware.hex"
    image.write_text(":00000001FF\n")
    with FakeBoard() as board, Device(board.port, 0.0, 0.5):
        with pytest.raises(UserError, match="the port is in use by another program"):
            module.flash(board.port, "mega", hex_file=image)


def test_missing_sources_and_files_are_bad_usage(tmp_path: Path) -> None:
    with FakeBoard() as board:
        with pytest.raises(UserError, match=r"holds no platformio\.ini; name the firmware folder") as caught:
            module.flash(board.port, "mega", firmware_dir=tmp_path)
        assert caught.value.exit_code == 2
        with pytest.raises(UserError, match=r"x\.hex: there is no such file") as caught:
            module.flash(board.port, "mega", hex_file=tmp_path / "x.hex")
        assert caught.value.exit_code == 2
        with pytest.raises(UserError, match="board 'uno' is unknown; choose one of mega, nano"):
            module.flash(board.port, "uno")


@pytest.mark.usefixtures("quick_device")
def test_avrdude_gets_the_boards_own_settings_and_the_firmware_is_greeted(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    script(tmp_path, "avrdude", "open(here + '/told', 'w').write(' '.join(sys.argv[1:]))")
    monkeypatch.setenv("PATH", str(tmp_path), prepend=os.pathsep)
    image = tmp_path / "firmware.hex"
    image.write_text(":00000001FF\n")
    with FakeBoard() as board:
        hello = module.flash(board.port, "mega", hex_file=image)
        assert (tmp_path / "told").read_text() == (
            f"-c wiring -p atmega2560 -P {board.port} -D -U flash:w:{image}:i -b 115200"
        )
    assert hello.board is schema.Board.MEGA2560


class Bootloader(threading.Thread):
    """The other end of a line: answers "get sync" when it is asked at its own speed."""

    def __init__(self, baud: int) -> None:
        super().__init__(daemon=True)
        self.master, self.slave = os.openpty()
        tty.setraw(self.slave)
        self.port = os.ttyname(self.slave)
        self.speed = getattr(termios, f"B{baud}")
        self.questions: set[int] = set()
        self.stop = threading.Event()
        self.start()

    def run(self) -> None:
        heard = b""
        while not self.stop.is_set():
            if not select.select([self.master], [], [], 0.02)[0]:
                continue
            speed = termios.tcgetattr(self.slave)[5]
            self.questions.add(speed)
            # At another speed a bootloader hears noise.
            heard = heard + os.read(self.master, 64) if speed == self.speed else b""
            if b"\x30\x20" in heard:
                os.write(self.master, b"\x14\x10")

    def __enter__(self) -> Self:
        return self

    def __exit__(self, *_: object) -> None:
        self.stop.set()
        self.join(10)
        os.close(self.master)
        os.close(self.slave)


@pytest.mark.parametrize("baud", [115200, 57600])
def test_the_speed_of_a_nanos_bootloader_is_found(baud: int, tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    script(tmp_path, "avrdude", "open(here + '/told', 'a').write(sys.argv[-1]); print('no more'); sys.exit(1)")
    monkeypatch.setenv("PATH", str(tmp_path), prepend=os.pathsep)
    image = tmp_path / "firmware.hex"
    image.write_text(":00000001FF\n")
    with Bootloader(baud) as line, pytest.raises(UserError, match="avrdude failed with exit code 1: no more"):
        module.flash(line.port, "nano", hex_file=image)
    assert (tmp_path / "told").read_text() == str(baud)


@pytest.mark.slow
def test_a_board_without_bootloader_is_named() -> None:
    with Bootloader(9600) as line:
        with pytest.raises(UserError, match="no bootloader answers at 115200 and 57600 baud"):
            find_speed(line.port, (115200, 57600))
        assert line.questions == {termios.B115200, termios.B57600}


@pytest.mark.usefixtures("quick_device")
def test_firmware_of_another_board_is_noticed(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    script(tmp_path, "avrdude", "")
    monkeypatch.setenv("PATH", str(tmp_path), prepend=os.pathsep)
    monkeypatch.setattr(module, "find_speed", lambda port, bauds: 57600)
    image = tmp_path / "firmware.hex"
    image.write_text(":00000001FF\n")
    with FakeBoard() as board, pytest.raises(UserError, match="flashed for nano, but .* built for Arduino Mega 2560"):
        module.flash(board.port, "nano", hex_file=image)


@pytest.mark.usefixtures("quick_device")
def test_platformio_builds_first_and_then_uploads(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    firmware = tmp_path / "tree" / "firmware"
    firmware.mkdir(parents=True)
    (firmware / "platformio.ini").write_text("")
    assembled = tmp_path / "tree" / "build" / "platformio" / "assembled"
    assembled.parent.mkdir(parents=True)
    assembled.touch()
    told: list[tuple[list[str], dict[str, str]]] = []
    monkeypatch.setattr(module, "run_tool", lambda tool, look: told.append((tool.command[3:], tool.environment)))
    with FakeBoard() as board:
        module.flash(board.port, "mega", firmware_dir=firmware)
        port = board.port
    build = ["run", "--project-dir", str(firmware), "--environment", "megaatmega2560"]
    assert [command for command, _ in told] == [build, [*build, "--target", "upload", "--upload-port", port]]
    for _, environment in told:
        assert environment["PLATFORMIO_CORE_DIR"] == str(assembled.parent)
        assert environment["PLATFORMIO_SETTING_ENABLE_TELEMETRY"] == "no"


@pytest.mark.usefixtures("quick_device")
def test_avrdudes_rows_become_fractions(image: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    def write_rows(tool: Tool, look: Callable[[str], None]) -> None:
        look("avrdude: writing flash\n\nWriting | #########################")
        look("Writing | ################################################## | 100% 1.2s\n\nReading | #####")

    monkeypatch.setattr(module, "run_tool", write_rows)
    seen: list[tuple[str, float]] = []
    with FakeBoard() as board:
        module.flash(board.port, "mega", hex_file=image, progress=lambda what, fraction: seen.append((what, fraction)))
    assert seen[0][0] == "looking for the bootloader"
    assert seen[1:-1] == [("writing", 0.5), ("writing", 1.0), ("verifying", 0.1)]
    assert seen[-1][0] == "greeting the firmware"


def test_a_port_that_goes_away_ends_the_upload(tmp_path: Path, image: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    port = tmp_path / "port"
    looks: list[str] = []

    def lose_the_port(tool: Tool, look: Callable[[str], None]) -> None:
        for text in ("Writing | ####", "Writing | #####"):
            look(text)
            looks.append(text)
            port.unlink()

    monkeypatch.setattr(module, "run_tool", lose_the_port)
    with FakeBoard() as board:
        port.symlink_to(board.port)
        with pytest.raises(UserError, match="port went away while it was being flashed; connect the board"):
            module.flash(str(port), "mega", hex_file=image)
    assert looks == ["Writing | ####"]
