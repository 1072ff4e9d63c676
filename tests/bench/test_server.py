"""Bench, serial port and wall clock together, with a stand-in for the board."""

from __future__ import annotations

import math
from collections.abc import Callable, Iterator
from pathlib import Path
from typing import Any, cast

import numpy as np
import pytest
import serial

from greywhale.arm import Wiring
from greywhale.base.errors import UserError
from greywhale.files.leader import save_leader
from greywhale.files.trajectory import Trajectory
from greywhale_sim import commands
from greywhale_sim.assemble import BenchOptions, build_bench
from greywhale_sim.bench import Bench
from greywhale_sim.pacing import Pacer
from greywhale_sim.serial_port import SerialPort
from greywhale_sim.server import Server


class Wall:
    """A wall clock that only waiting moves; `meanwhile` is what else happens while the bench waits."""

    def __init__(self) -> None:
        self.now = 0.0
        self.meanwhile: Callable[[], None] = lambda: None

    def wait(self, seconds: float) -> None:
        self.now += seconds
        self.meanwhile()


@pytest.fixture
def wall() -> Wall:
    return Wall()


@pytest.fixture
def eeprom(tmp_path: Path) -> Path:
    return tmp_path / "eeprom.bin"


def serve(bench: Bench, wall: Wall, eeprom: Path) -> Server:
    return Server(bench, SerialPort(), fast=True, eeprom=eeprom, pacer=Pacer(lambda: wall.now, wall.wait))


def turn(server: Server, times: int) -> None:
    for _ in range(times):
        server.turn()


@pytest.fixture
def server(bench: Bench, wall: Wall, eeprom: Path) -> Iterator[Server]:
    server = serve(bench, wall, eeprom)
    yield server
    server.close()


def test_opening_resets_the_board_before_the_first_byte(board: Any, server: Server) -> None:
    server.turn()
    with serial.Serial(server.port.path, 1_000_000) as host:
        host.write(b"first")
        server.turn()
        assert board.events == ["reset", "bytes"]
        assert bytes(board.received) == b"first"
        host.write(b"second")
        server.turn()
        assert board.events == ["reset", "bytes", "bytes"]
        host.write(b"last words")
    server.turn()
    assert board.received.endswith(b"last words")
    with serial.Serial(server.port.path, 1_000_000):
        server.turn()
        assert board.events[-1] == "reset"
        assert server.resets_by_host == 2


def test_a_new_host_hears_nothing_from_before(board: Any, server: Server) -> None:
    board.to_send += b"nobody hears this"
    server.turn()
    with serial.Serial(server.port.path, 1_000_000, timeout=0) as host:
        server.turn()
        board.to_send += b"hello"
        server.turn()
        assert host.read(100) == b"hello"
        board.to_send += b"left unread"
        server.turn()
    server.turn()
    with serial.Serial(server.port.path, 1_000_000, timeout=0) as host:
        server.turn()
        assert host.read(100) == b""


def test_a_wrong_speed_garbles_both_ways(board: Any, server: Server) -> None:
    with serial.Serial(server.port.path, 115_200, timeout=0) as host:
        host.write(b"hello")
        board.to_send += b"hello"
        server.turn()
        assert bytes(board.received) != b"hello"
        assert host.read(100) != b"hello"


def test_nobody_connected_keeps_real_time_and_a_host_does_not(server: Server, wall: Wall) -> None:
    turn(server, 100)
    assert wall.now == pytest.approx(server.bench.time_s, abs=0.02)
    with serial.Serial(server.port.path, 1_000_000):
        server.turn()
        before = wall.now
        turn(server, 100)
        assert wall.now == before


def test_simulated_time_waits_for_a_slow_reader(board: Any, server: Server, wall: Wall) -> None:
    with serial.Serial(server.port.path, 1_000_000, timeout=1) as host:
        server.turn()
        board.to_send += bytes(2000)
        waits: list[float] = []

        def read_at_last() -> None:
            waits.append(wall.now)
            if len(waits) == 3:
                host.read(2000)

        wall.meanwhile = read_at_last
        server.turn()
        assert len(waits) == 3


def test_a_host_that_dies_with_bytes_unread_does_not_stop_the_bench(board: Any, server: Server, wall: Wall) -> None:
    host = serial.Serial(server.port.path, 1_000_000)
    server.turn()
    board.to_send += bytes(2000)
    wall.meanwhile = host.close
    server.turn()
    assert not server.port.connected
    assert cast(SerialPort, server.port).unread() == 0


def test_eeprom_reaches_its_file_when_it_changes(board: Any, bench: Bench, wall: Wall, eeprom: Path) -> None:
    server = serve(bench, wall, eeprom)
    turn(server, 20)
    assert not eeprom.exists(), "nothing was written, so there is nothing to keep"
    board.counters.eeprom_writes += 1  # a write has begun, its cell does not hold the byte yet
    turn(server, 20)
    for value in (b"\x5a", b"\xa5"):
        board.memory = value * 4096
        turn(server, 20)
        assert eeprom.read_bytes() == value * 4096
    assert [path.name for path in eeprom.parent.iterdir()] == [eeprom.name]
    board.memory = b"\x77" * 4096
    server.close()
    assert eeprom.read_bytes() == b"\x77" * 4096, "the last byte is kept when the bench ends"


def test_a_power_cut_keeps_what_the_eeprom_holds_at_that_moment(board: Any, server: Server, eeprom: Path) -> None:
    server.turn()
    board.memory = b"\x33" * 4096
    server.power_off()
    assert eeprom.read_bytes() == b"\x33" * 4096
    assert not commands.run(server, "status")["powered"]
    with serial.Serial(server.port.path, 1_000_000) as host:
        host.write(b"anybody there?")
        server.turn()
    assert board.received == b""
    server.power_on()
    assert [event for event in board.events if event != "reset"] == ["off 2", "on 2"]


def test_a_power_cut_can_wait_for_eeprom_writes(board: Any, server: Server) -> None:
    board.counters.eeprom_writes = 100
    commands.run(server, "power off 3")
    for writes in (100, 101, 102):
        board.counters.eeprom_writes = writes
        server.turn()
        assert board.powered
    board.counters.eeprom_writes = 103
    server.turn()
    assert not board.powered
    server.power_on()
    server.turn()
    assert board.powered, "one cut was ordered"


def test_what_can_be_changed_is_told_with_its_ends_and_as_it_is(server: Server) -> None:
    assert commands.run(server, "line flip 0.25") == {"flip": 0.25, "lose": 0.0}
    found = commands.run(server, "controls")
    assert found["supply"] == {"minimum": 0.0, "maximum": 30.0, "value": 12.0}
    assert "load" not in found, "this arm is no arm of the bench"
    assert commands.run(server, "supply 9.5") == {"supply_v": 9.5}
    assert commands.run(server, "speed 0.25") == {"speed": "0.25"}
    assert not server.fast
    commands.run(server, "power off")
    found = commands.run(server, "controls")
    assert (found["supply"]["value"], found["speed"]["value"], found["power"]) == (9.5, 0.25, False)
    for fault in found["faults"]:
        for place in fault["places"] or [""]:
            commands.run(server, f"mistake {fault['name']}{place and ':'}{place}")
    with pytest.raises(UserError, match="can be loaded, pushed or obstructed"):
        commands.run(server, "load 0.2")


def test_a_load_pulls_the_arm_down_and_a_hand_pushes_a_joint_against_what_is_in_its_way(
    eeprom: Path, wall: Wall
) -> None:
    bench = build_bench(BenchOptions())
    server = serve(bench, wall, eeprom)

    def rest(joint: int = 0, ms: int = 500) -> float:
        for _ in range(ms):
            bench.angles[:] = cast(Any, bench.plant).step([0.0] * 4, 0.001)
        return float(bench.angles[joint])

    falls = {}
    for mass in (0.5, 0.0):
        assert commands.run(server, f"load {mass}")["load_kg"] == mass
        bench.place(np.zeros(4))
        bench.leader.hold = None
        falls[mass] = -rest(joint=1, ms=200)
        before = bench.angles.copy()
        bench.load_tip(mass)
        np.testing.assert_allclose(cast(Any, bench.plant).step([0.0] * 4, 1e-6), before, atol=1e-6)
    assert falls[0.5] > falls[0.0] + 0.01
    bench.place(np.zeros(4))
    assert commands.run(server, "push 0 0.5") == {"push": 0, "torque_nm": 0.5}
    assert commands.run(server, "obstacle 0 20")["angle"] == pytest.approx(math.radians(20))
    assert rest() == pytest.approx(math.radians(20), abs=1e-3)
    bench.load_tip(0.1)
    assert rest() == pytest.approx(math.radians(20), abs=1e-3), "neither goes away with another load"
    commands.run(server, "obstacle 0 none")
    assert rest() > math.radians(30)
    commands.run(server, "push 0 0")
    assert rest() == pytest.approx(rest(), abs=1e-3)


def test_a_potentiometer_floats_until_it_is_connected_again(server: Server, board: Any) -> None:
    assert commands.run(server, "pot leader 1 floating") == {"pot": "leader_1", "state": "floating"}
    commands.run(server, "pot follower 2 floating")
    commands.run(server, "pot leader 1 connected")
    commands.run(server, "pot follower 2 open")
    assert board.events == ["floating 0x2", "floating 0x42", "floating 0x40", "floating 0x0"]
    assert server.bench.pot_wiring(4 + 2) == Wiring.OPEN


def test_the_emergency_stop_closes_its_pin_to_ground_until_it_is_released(server: Server, board: Any) -> None:
    assert commands.run(server, "estop press") == {"estop_pressed": True}
    assert commands.run(server, "status")["estop_pressed"]
    assert commands.run(server, "estop release") == {"estop_pressed": False}
    assert not commands.run(server, "status")["estop_pressed"]
    assert board.events == ["hold B4 low", "let B4 go"]


def test_the_person_takes_up_another_motion_at_work_and_between_two_enables(
    server: Server, board: Any, tmp_path: Path
) -> None:
    file = tmp_path / "another motion.csv"
    save_leader(file, Trajectory(np.array([0.0, 2.0]), np.array([[0.5] * 4, [1.0] * 4])))
    board.pins = np.ones(17)
    server.turn()
    assert commands.run(server, "leader steps")["duration_s"] == 16.0
    assert commands.run(server, f"leader '{file}'") == {"leader": str(file), "duration_s": 2.0}
    server.bench.run(10.0)
    assert commands.run(server, "status")["leader"] == [1.0] * 4
    board.pins = np.zeros(17)
    assert commands.run(server, f"leader '{file}'") == {"leader": str(file), "duration_s": 2.0}
    server.bench.run(2.0)
    assert commands.run(server, "status")["follower"] == [0.5] * 4
    with pytest.raises(UserError, match="nowhere.csv: cannot be read"):
        commands.run(server, "leader nowhere.csv")


@pytest.mark.parametrize(
    "text",
    [
        *("leader", "leader 'unfinished", "leader a b"),
        *("", "fly", "speed", "speed 2", "power maybe", "line flip", "line flip much", "line flip 2"),
        *("pot nobody 1 open", "pot leader 4 open", "pot leader x open", "pot leader 1 melted", "status now"),
        *("estop", "estop hit", "speed 0.01", "speed nan", "supply -1", "supply", "load 100", "load nan"),
        *("obstacle 4 0", "obstacle 0 nan", "obstacle 0", "push 0 100", "push 4 0", "push 0 nan"),
        *("lead 1 2 3", "lead 1 2 3 nan", "lead 1 2 3 7"),
    ],
)
def test_bad_commands_are_answered_with_a_sentence(server: Server, text: str) -> None:
    with pytest.raises(UserError):
        commands.run(server, text)
    assert server.fast
    assert server.board.powered
    assert server.noise.flip == 0.0
