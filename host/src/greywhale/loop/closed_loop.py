"""The native closed loop: one leader and one board, any number of candidates. No other module calls it."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any, Self

import numpy as np
import numpy.typing as npt

from greywhale import _native
from greywhale.arm import ArmParameters, PotentiometerBank
from greywhale.arm.plant import native_potentiometers
from greywhale.arm.plants import Plants
from greywhale.base.errors import UserError
from greywhale.base.types import Controllers, Floats
from greywhale.files.trajectory import Trajectory
from greywhale.loop.leader import SLICES_PER_TICK
from greywhale.protocol.firmware import ANGLE_LSB, JOINTS, TICK_S, pwm_steps
from greywhale.protocol.joints import unused
from greywhale.protocol.table import ParameterTable

Counts = npt.NDArray[np.int16]

LATEST_CHAIN_CYCLES = 7000  # cycles: a chain takes 12,944 and must end before the next tick
LONGEST_DELAY_TICKS = 1000  # ticks


@dataclass(frozen=True)
class Timing:
    """The moments of things within a tick of 1 ms, which spans four slices of 250 us and begins somewhere in the first.

    `chain_start`: cycles (16 MHz) from the beginning of that slice to the first of the tick's 32 conversions.
    `acts`: the slice (1..3) from whose beginning each joint's new voltage acts.
    `drivers_on`: the slice (1..4, of tick 0) that first finds the drivers on. The hand lets go of the follower a slice
    later, and the controllers run from tick 1 on.
    `late`: ticks by which every duty acts later than the firmware gives it. No board does that; a controller with a
    margin can bear it.

    On the bench all but `late` depend on the cycle at which the board was switched on. The defaults are those of a tick
    that begins with its slice and is done within it.
    """

    chain_start: int = 2208
    acts: tuple[int, int, int, int] = (1, 1, 1, 1)
    drivers_on: int = 1
    late: int = 0

    def __post_init__(self) -> None:
        if not 0 <= self.chain_start <= LATEST_CHAIN_CYCLES:
            raise UserError(
                f"chain_start is {self.chain_start}, but it must be a number of cycles in 0..{LATEST_CHAIN_CYCLES}."
            )
        if not 0 <= self.late <= LONGEST_DELAY_TICKS:
            raise UserError(f"late is {self.late}, but it must be a number of ticks in 0..{LONGEST_DELAY_TICKS}.")
        if self.drivers_on not in (1, 2, 3, 4):
            raise UserError(f"drivers_on is {self.drivers_on}, but it must name a slice from 1 to 4.")
        if len(self.acts) != JOINTS or not all(1 <= slice_number < SLICES_PER_TICK for slice_number in self.acts):
            raise UserError(f"acts is {self.acts}, but it must name a slice from 1 to 3 for each of the four joints.")

    def native(self) -> _native.LoopTiming:
        return _native.LoopTiming(start=self.chain_start, acts=self.acts, on=self.drivers_on, late=self.late)


DEFAULT_TIMING = Timing()


@dataclass(frozen=True)
class Result:
    """A row per candidate and a column per joint. Measures compare readings, as a log does: e = leader - follower.

    Noise, a converter's steps and a bent potentiometer are not in e; a zero angle, play and lag are.
    A candidate whose motion leaves the range of numbers has `diverged` set and 1e9 in every measure.
    """

    mse: Floats  # (n, 4) rad^2, mean of e^2 over the ticks
    itae: Floats  # (n, 4) rad s^2, integral of weight |e|
    itau: Floats  # (n, 4) V s^2, integral of weight |u|, u the voltage at the motor
    diverged: npt.NDArray[np.bool_]  # (n,)
    time_s: Floats  # (rows,) of the traces
    angles: npt.NDArray[np.float32]  # (n, rows, 4) rad, the follower's
    duties: npt.NDArray[np.int16]  # (n, rows, 4) PWM compare values with their direction


@dataclass(frozen=True)
class Readings:
    """The leader as the board sees it, and the angle that a follower's is measured against: a row a tick."""

    reference: Counts  # (ticks, 4) in ANGLE_LSB
    leader: Floats  # (ticks, 4) rad


@dataclass(frozen=True)
class FollowerLines:
    """The follower's angle that the board reads as an angle of the leader: times x the leader's + plus, (4,) each.

    It is another angle where the zero angles of both sides are not those of the board's table.
    """

    times: Floats
    plus: Floats  # rad

    @classmethod
    def of(cls, arm: ArmParameters, table: ParameterTable) -> Self:
        leader, follower = arm.leader_pots, arm.follower_pots
        lines = _native.follower_lines(
            settings=settings_of(table),
            leader_pots=native_potentiometers(leader),
            leader_supply=leader.supply,
            follower_pots=native_potentiometers(follower),
            follower_supply=follower.supply,
        )
        times, plus = np.asarray(lines, dtype=np.float64)
        still = list(unused(arm.joints_in_use))
        times[still], plus[still] = 1.0, 0.0
        return cls(times, plus)

    def follower(self, leader: Floats) -> Floats:
        """Angles (..., 4) of the follower."""
        angles: Floats = self.times * leader + self.plus
        return angles

    def motion(self, leader: Trajectory) -> Trajectory:
        """A motion of the leader as the follower has to make it."""
        return Trajectory(leader.time_s, self.follower(leader.angles))

    def leader(self, follower: Floats, joint: int) -> Floats:
        """Angles of the leader's joint, by the follower's."""
        angles: Floats = (follower - self.plus[joint]) / self.times[joint]
        return angles


def read_leader(
    table: ParameterTable, pots: PotentiometerBank, slices: Floats, *, seed: int, noise: bool, timing: Timing
) -> Readings:
    """Read leader angles (rad, four slices a tick) through potentiometers, converter and the firmware's calibration."""
    reference, leader = _native.leader_readings(
        settings=settings_of(table),
        timing=timing.native(),
        pots=native_potentiometers(pots, noise),
        pot_supply=pots.supply,
        seed=seed,
        angles=slices,
    )
    return Readings(reference, leader)


def known_readings(reference: Floats, leader: Floats | None = None) -> Readings:
    """The readings of a leader whose readings are known, (ticks, 4) rad: from a log, or because the host leads.

    The follower is measured against `leader`, by default these readings.
    """
    counts = np.clip(np.round(reference / ANGLE_LSB), -32768, 32767).astype(np.int16)
    return Readings(np.ascontiguousarray(counts), np.ascontiguousarray(reference if leader is None else leader))


class ClosedLoop:
    """Leader, follower's potentiometers and board settings, shared by all candidates.

    The follower starts at `home` (4,) rad. `gap` (4,) is the place of each gear in its backlash (-1 to 1). `weight_s`
    (ticks,) weighs |e| and |u| in ITAE and ITAU. `instructions` is one of _native.instruction_sets(), by default the
    best; the results are the same bits with all.
    """

    def __init__(
        self,
        table: ParameterTable,
        readings: Readings,
        pots: PotentiometerBank,
        *,
        seed: int,
        home: Sequence[float],
        gap: Sequence[float],
        weight_s: Floats,
        noise: bool = True,
        timing: Timing = DEFAULT_TIMING,
        soft_start: bool = False,
        instructions: str = "",
    ) -> None:
        self.ticks = len(readings.reference)
        self.time_s: Floats = np.arange(self.ticks, dtype=np.float64) * TICK_S
        self._loop = _native.ClosedLoop(
            settings=settings_of(table, soft_start),
            timing=timing.native(),
            pots=native_potentiometers(pots, noise),
            pot_supply=pots.supply,
            seed=seed,
            home=[float(angle) for angle in home],
            gap=[float(share) for share in gap],
            reference=readings.reference,
            leader=readings.leader,
            weight=weight_s,
            instructions=instructions,
        )

    def run(
        self,
        controllers: Controllers,
        plants: Plants,
        *,
        substeps: int,
        every: int = 0,
        threads: int = 0,
        exact: bool = False,
    ) -> Result:
        """Simulate candidates that are already checked; Experiment explains the arguments, and checks them."""
        try:
            outcome = self._loop.run(
                controllers=controllers,
                plants=plants,
                substeps=substeps,
                threads=threads,
                every=every,
                exact=exact,
            )
        except ValueError as error:
            raise UserError(str(error)) from None
        mse, itae, itau, diverged, angles, duties = outcome
        time_s = self.time_s[::every] if every else self.time_s[:0]
        return Result(mse, itae, itau, diverged, time_s, angles, duties)


def settings_of(table: ParameterTable, soft_start: bool = False) -> _native.LoopSettings:
    """The settings of the firmware around the law, from the table. Joints that are not in use have limits of 0."""
    return _native.LoopSettings(**settings_numbers(table, soft_start))


def settings_numbers(table: ParameterTable, soft_start: bool = False) -> dict[str, Any]:
    """The settings as numbers by name, in the order of Settings in host/native/closed_loop/experiment.h."""
    lower, upper = table.limits_raw()
    return {
        "period_ms": table.period_ms,
        "supply_mv": table["supply_mv"],
        "soft_start_ms": table["soft_start_ms"] if soft_start else 0,
        "filter_shift": table["filter_shift"],
        "limit_min": lower,
        "limit_max": upper,
        "motor_sign": table.each("joint", "motor_sign"),
        "pwm_top": pwm_steps(table.board),
        "leader_zero": table.each("leader", "zero"),
        "leader_scale": table.each("leader", "scale"),
        "follower_zero": table.each("follower", "zero"),
        "follower_scale": table.each("follower", "scale"),
    }


def with_ideal_follower(table: ParameterTable) -> ParameterTable:
    """A copy of the board with correctly wired motors and usual potentiometers, because a log's angles are already
    calibrated.
    """
    usual = ParameterTable.defaults()
    keys = ("follower", "zero"), ("follower", "scale"), ("joint", "motor_sign")
    names = [f"{group}{joint}.{key}" for group, key in keys for joint in table.joints_in_use]
    return table.with_raw({name: usual[name] for name in names})


def with_right_motors(table: ParameterTable) -> ParameterTable:
    """A copy of the board with every `motor_sign` 1: it says how a motor's wires are, and an arm's model has none."""
    return table.with_raw({f"joint{joint}.motor_sign": 1 for joint in range(JOINTS)})


def shown_angles(angles: npt.NDArray[np.float32], plants: Plants, row_s: float) -> Floats:
    """Readings of the plants' potentiometers, (n, rows, 4) rad, for joint angles with a row every `row_s` seconds.

    Play and lag are in it; noise and a bent line are not.
    """
    return np.asarray(_native.shown_angles(angles=angles, plants=plants, row_s=row_s))
