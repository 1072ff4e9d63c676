"""Stand-ins for the board and the arm: the bench's own rules are tested without a processor."""

from __future__ import annotations

from dataclasses import dataclass, field

import numpy as np
import pytest

from greywhale.arm.parameters import Potentiometer, PotentiometerBank
from greywhale.files.trajectory import Trajectory
from greywhale_sim.bench import SLICE_S, Bench
from greywhale_sim.leader_player import LeaderPlayer
from greywhale_sim.wiring import MEGA


@dataclass
class FakeStats:
    resets: int = 0
    eeprom_writes: int = 0
    watchdog_resets: int = 0
    rx_overruns: int = 0


@dataclass
class FakeBoard:
    """Pins as the test sets them; remembers what the bench did to it."""

    cycle: int = 0
    pc: int = 0
    baud: float = 1e6
    in_bootloader: bool = False
    powered: bool = True
    result: int = 0
    crash_reason: str = "a write to nowhere"
    pins: np.ndarray = field(default_factory=lambda: np.zeros(17))
    millivolts: list[np.ndarray] = field(default_factory=list)
    received: bytearray = field(default_factory=bytearray)  # from the host
    to_send: bytearray = field(default_factory=bytearray)  # to the host
    events: list[str] = field(default_factory=list)
    memory: bytes = bytes(4096)
    counters: FakeStats = field(default_factory=FakeStats)

    def add_duty_output(self, timer: int, channel: str) -> int:
        return 0

    def add_pin_output(self, port: str, bit: int) -> int:
        return 0

    def hold_pin(self, port: str, bit: int, high: bool) -> None:
        self.events.append(f"hold {port}{bit} {'high' if high else 'low'}")

    def let_pin_go(self, port: str, bit: int) -> None:
        self.events.append(f"let {port}{bit} go")

    def outputs(self) -> np.ndarray:
        return self.pins

    def set_millivolts(self, millivolts: np.ndarray) -> None:
        self.millivolts.append(millivolts.copy())

    def set_floating(self, inputs: int) -> None:
        self.events.append(f"floating {inputs:#x}")

    def set_joined(self, inputs: int, wipers: int) -> None:
        self.events.append(f"joined {inputs:#x}")

    def set_supply(self, millivolts: int, seed: int = 1) -> None:
        self.events.append(f"supply {millivolts}")

    def run_until(self, cycle: int) -> int:
        self.cycle = cycle + 1  # the last instruction ends a little late, as on the real thing
        return self.result

    def uart_send(self, data: bytes) -> None:
        self.events.append("bytes")
        self.received += data

    def uart_receive(self) -> bytes:
        data = bytes(self.to_send)
        self.to_send.clear()
        return data

    def reset(self) -> None:
        self.events.append("reset")

    def power_off(self, seed: int) -> None:
        self.events.append(f"off {seed}")
        self.powered = False

    def power_on(self, seed: int) -> None:
        self.events.append(f"on {seed}")
        self.powered = True

    def stats(self) -> FakeStats:
        return self.counters

    def eeprom(self) -> bytes:
        return self.memory


class FakePlant:
    """Integrates voltage to angle: 1 rad/s a volt."""

    def __init__(self) -> None:
        self.angles = np.zeros(4)
        self.voltages: list[list[float]] = []

    def step(self, voltages: np.ndarray, dt: float) -> np.ndarray:
        self.voltages.append(voltages.tolist())
        self.angles = self.angles + voltages * dt
        return self.angles

    def reset(self, angles: np.ndarray) -> None:
        self.angles = np.array(angles)


# 1 V a radian around 2.5 V.
POTS = (PotentiometerBank(joint=(Potentiometer(track=5.0),) * 4),) * 2


@pytest.fixture
def motion() -> Trajectory:
    """Every joint from its own start (0, 0.1, 0.2, 0.3 rad) 1 rad up within a second at constant speed."""
    rows = np.arange(101) / 100
    return Trajectory(rows, rows[:, None] + np.array([0.0, 0.1, 0.2, 0.3]))


@pytest.fixture
def board() -> FakeBoard:
    return FakeBoard()


@pytest.fixture
def plant() -> FakePlant:
    return FakePlant()


@pytest.fixture
def bench(board: FakeBoard, plant: FakePlant, motion: Trajectory) -> Bench:
    player = LeaderPlayer(motion, SLICE_S)
    return Bench(board, MEGA, plant, player, POTS, supply_v=12.0)
