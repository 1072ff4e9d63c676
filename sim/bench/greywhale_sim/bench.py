"""The bench: board, arm and leader in lock step on one simulated clock (sim/bench in C++ does the work).

Time advances in slices of 250 us. In each slice the bench reads the driver pins, moves the arm under the voltages that
they mean, puts all eight potentiometers on the converter's inputs and lets the processor run. Nothing here looks at the
wall clock: the same bytes into the serial port at the same cycles give the same trace.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from typing import Protocol

import numpy as np

from greywhale import _native
from greywhale.arm.parameters import ArmParameters, PotentiometerBank
from greywhale.arm.plant import native_potentiometers
from greywhale.base.errors import UserError
from greywhale.base.types import Floats
from greywhale.protocol.joints import ALL, Joints
from greywhale_sim.drivers import CHIPS, Chip
from greywhale_sim.leader_player import LeaderPlayer
from greywhale_sim.wiring import Wiring

CLOCK_HZ = _native.CLOCK_HZ
SLICE_CYCLES = _native.SLICE_CYCLES
SLICE_S = SLICE_CYCLES / CLOCK_HZ
SLICES_PER_S = CLOCK_HZ // SLICE_CYCLES
CRASHED = 2


class Board(Protocol):
    """The interface of the simulated Arduino that the bench uses (greywhale._native.Board)."""

    @property
    def cycle(self) -> int: ...
    @property
    def pc(self) -> int: ...
    @property
    def crash_reason(self) -> str: ...
    def add_duty_output(self, timer: int, channel: str) -> int: ...
    def add_pin_output(self, port: str, bit: int) -> int: ...
    def hold_pin(self, port: str, bit: int, high: bool) -> None: ...
    def let_pin_go(self, port: str, bit: int) -> None: ...
    def outputs(self) -> Floats: ...
    def set_millivolts(self, millivolts: Floats) -> None: ...
    def set_floating(self, inputs: int) -> None: ...
    def set_joined(self, inputs: int, wipers: int) -> None: ...
    def set_supply(self, millivolts: int, seed: int = 1) -> None: ...
    def run_until(self, cycle: int) -> int: ...


class Plant(Protocol):
    """The follower arm: any object that turns four motor voltages into four joint angles after `dt` seconds."""

    def step(self, voltages: Floats, dt: float) -> Floats | Sequence[float]: ...


class CrashError(UserError):
    """The program did what no program should do: an invalid instruction, or an access outside the memory."""


# Called after every slice: cycle reached, pins at its beginning, follower's angles. The angles' array is reused.
Trace = Callable[[int, Floats, Floats], None]


class Bench(_native.Bench):
    """Lock step of one board, one plant and one leader; `run` is synchronous and deterministic.

    The plant is the bench's own arm with these parameters, or a `Plant` of another engine.
    """

    def __init__(
        self,
        board: Board,
        wiring: Wiring,
        plant: ArmParameters | Plant,
        leader: LeaderPlayer,
        pots: tuple[PotentiometerBank, PotentiometerBank],  # the leader's and the follower's
        supply_v: float,
        chip: Chip = CHIPS["drv8838"],
        emf: Floats | None = None,  # V s of each motor at its output shaft; needed where a chip lets motors coast
        joints: Joints = ALL,  # in use; the others have no potentiometers and no motor
        seed: int = 1,  # of everything random
    ) -> None:
        own = plant.native() if isinstance(plant, ArmParameters) else plant
        leader_bank, follower_bank = pots
        parts = _native.BenchPots(
            leader=native_potentiometers(leader_bank),
            leader_supply=leader_bank.supply,
            follower=native_potentiometers(follower_bank),
            follower_supply=follower_bank.supply,
        )
        in_use = sum(1 << joint for joint in joints)
        electrics = _native.BenchElectrics(chip.kind, supply_v, np.zeros(4) if emf is None else emf, in_use)
        super().__init__(board, wiring.native(), leader, own, parts, seed, electrics)
        # The native bench counts on these to live as long as it does, and to stay what they are.
        self._board, self._leader, self._plant = board, leader, plant
        self.wiring = wiring
        self.joints = joints
        self.trace: Trace | None = None

    @property
    def board(self) -> Board:
        return self._board

    @property
    def leader(self) -> LeaderPlayer:
        """The person at the bench."""
        return self._leader

    @property
    def plant(self) -> _native.Arm | Plant:
        """The bench's own arm, or what moves in its place."""
        if isinstance(self._plant, ArmParameters):
            assert self.own_arm is not None
            return self.own_arm
        return self._plant

    def become(self, parameters: ArmParameters) -> None:
        """Let the arm be another one from now on, where it is and at rest."""
        self._require_own_arm()
        if parameters != self._plant:
            self._plant = parameters
            self.become_own(parameters.native())

    @property
    def time_s(self) -> float:
        return self.board.cycle / CLOCK_HZ

    @property
    def motors_enabled(self) -> bool:
        """The drivers' enable pin, as it is now."""
        return bool(self.board.outputs()[0])

    def run(self, seconds: float) -> None:
        """Advance by `seconds` of simulated time, rounded to whole slices."""
        self.run_slices(round(seconds * SLICES_PER_S))

    def run_slices(self, count: int) -> None:
        if not self.advance(count, self.trace):
            board = self.board
            raise CrashError(
                f"the program on the simulated board crashed at address {board.pc:#07x}: {board.crash_reason}."
            )

    def load_tip(self, mass_kg: float) -> None:
        """Let the arm carry so many kg."""
        self._require_own_arm()
        self.load_own_tip(mass_kg)

    def obstruct(self, joint: int, angle: float | None) -> None:
        """Put something hard in a joint's way, at an angle (rad) on either side of it; None takes it away."""
        self._require_own_arm()
        self.obstruct_own(joint, angle)

    def push(self, joint: int, torque_nm: float) -> None:
        """Let a hand push on a joint of the follower, until the next call."""
        self._require_own_arm()
        self.push_own(joint, torque_nm)

    def _require_own_arm(self) -> None:
        if self.own_arm is None:
            raise UserError("only the bench's own arm can be loaded, pushed or obstructed.")
