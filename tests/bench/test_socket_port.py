"""The TCP port of a bench: who has it, what a connection does, and what it cannot tell."""

from __future__ import annotations

from collections.abc import Iterator

import pytest
import serial

from greywhale.base import system
from greywhale.base.bench_process import BenchProcess
from greywhale.base.errors import UserError
from greywhale.board.device import Device
from greywhale_sim.line import resample
from greywhale_sim.serve import ServeOptions, running
from greywhale_sim.socket_port import SocketPort


@pytest.fixture
def port() -> Iterator[SocketPort]:
    port = SocketPort("0")
    yield port
    port.close()


def until(port: SocketPort, count: int) -> bytes:
    """So many bytes from the host."""
    data = b""
    while len(data) < count:
        data += port.read()
    return data


def test_pyserial_opens_it_and_a_connection_is_told_once(port: SocketPort) -> None:
    assert not port.poll()
    with serial.serial_for_url(port.path, timeout=5) as host:
        assert port.poll()
        assert port.connected
        assert not port.poll()
        host.write(b"abc")
        assert until(port, 3) == b"abc"
        assert port.write(b"xyz") == 3
        assert host.read(3) == b"xyz"
    while port.connected:  # until the end of the connection has come through
        port.read()
    with serial.serial_for_url(port.path):
        assert port.poll(), "each connection is a DTR that rises"


def test_a_second_program_is_turned_away(port: SocketPort) -> None:
    with serial.serial_for_url(port.path), serial.serial_for_url(port.path, timeout=5) as second:
        assert port.poll()
        assert not port.poll()
        with pytest.raises(serial.SerialException):
            second.read(1)
        assert port.connected


def test_a_system_whose_terminals_tell_nothing_gets_a_tcp_port(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(system, "HAS_BENCH_PORTS", False)
    with running(ServeOptions()) as server:
        assert server.port.path.startswith("socket://127.0.0.1:")


def test_a_full_queue_loses_bytes_and_blocks_nobody(port: SocketPort) -> None:
    fitted = [port.write(bytes(1000)) for _ in range(200)]
    assert fitted[0] == 1000
    assert fitted[-1] < 1000


def test_it_has_no_speed_and_so_no_wrong_one(port: SocketPort) -> None:
    sent = bytes(range(256))
    assert resample(sent, port.baud(), 57_600) == resample(sent, 1_000_000, port.baud()) == sent


@pytest.mark.parametrize("listen", ["here", "127.0.0.1", "127.0.0.1:none", "127.0.0.1:70000", ":", "a/b:5"])
def test_what_is_no_port_is_refused_by_name(listen: str) -> None:
    with pytest.raises(UserError, match="--listen"):
        SocketPort(listen)


def test_a_port_that_is_taken_is_refused_by_name(port: SocketPort) -> None:
    with pytest.raises(UserError, match=r"cannot listen there: address already in use"):
        SocketPort(port.path.rpartition(":")[2])


def test_time_cannot_run_as_fast_as_the_host_reads() -> None:
    with pytest.raises(UserError, match="leave out --speed max"):
        with running(ServeOptions(listen="0", speed="max")):
            pass


@pytest.mark.slow
def test_a_host_greets_a_board_behind_it_and_each_greeting_restarts_it() -> None:
    with BenchProcess("--listen", "0") as bench:
        assert bench.port.startswith("socket://127.0.0.1:")
        for count in (1, 2):
            with Device(bench.port, restart=False) as device:
                assert device.restarted
                assert bench.command("status")["resets_by_host"] == count
