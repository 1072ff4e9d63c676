"""The pseudo-terminal as an Arduino's USB port: who opens it, at which speed, and what is lost."""

from __future__ import annotations

import os
from collections.abc import Iterator
from pathlib import Path

import pytest
import serial

from greywhale.base.errors import UserError
from greywhale_sim.serial_port import SerialPort


@pytest.fixture
def port() -> Iterator[SerialPort]:
    port = SerialPort()
    yield port
    port.close()


def test_first_open_is_told_once(port: SerialPort) -> None:
    assert not port.poll()
    assert not port.connected
    with serial.Serial(port.path, 1_000_000):
        assert port.poll()
        assert port.connected
        assert not port.poll()
        assert port.connected
        with serial.Serial(port.path, 1_000_000):
            assert not port.poll(), "a second user opens no line that is open already"
        assert not port.poll()
        assert port.connected
    assert not port.poll()
    assert not port.connected


def test_backlog_is_an_upper_bound_that_reading_clears(port: SerialPort) -> None:
    with serial.Serial(port.path, timeout=5) as host:
        for written in range(100, 1001, 100):
            port.write(bytes(100))
            assert port.backlog(500) == written
        host.read(999)
        assert port.backlog(500) == 1000, "one byte is left, so the bound stays"
        host.read(1)
        assert port.backlog(1000) == 1000, "not above the limit: not worth a look"
        assert port.backlog(500) == 0


def test_a_full_queue_loses_bytes_and_blocks_nobody(port: SerialPort) -> None:
    fitted = [port.write(bytes(1000)) for _ in range(200)]
    assert fitted[0] == 1000
    assert fitted[-1] < 1000


def test_a_host_that_reads_late_loses_nothing_that_a_real_port_would_keep(port: SerialPort) -> None:
    sent = bytes(number % 256 for number in range(60_000))
    with serial.Serial(port.path, timeout=5) as host:
        host.write(sent[:256])
        assert port.read() == sent[:256]
        assert port.write(sent) == len(sent)
        got = b""
        while len(got) < len(sent):
            got += host.read(max(1, host.in_waiting))
            port.write(b"")
    assert got == sent


def test_link_names_the_port_while_it_lives(tmp_path: Path) -> None:
    link = tmp_path / "bench"
    link.symlink_to("/dev/pts/999999")  # left behind by a bench that was killed
    port = SerialPort(links=(link,))
    assert os.readlink(link) == port.path
    port.close()
    assert not link.is_symlink()


def test_link_replaces_no_file(tmp_path: Path) -> None:
    precious = tmp_path / "thesis.tex"
    precious.write_text("text")
    with pytest.raises(UserError, match="not a link"):
        SerialPort(links=(precious,))
    assert precious.read_text() == "text"
