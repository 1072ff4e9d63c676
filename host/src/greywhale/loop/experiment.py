"""One experiment with the closed loop: what all candidates share, and what comes out for each."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Literal

import numpy as np
import numpy.typing as npt

from greywhale import _native
from greywhale.arm import ArmParameters, PotentiometerBank
from greywhale.errors import UserError
from greywhale.loop.leader import SLICES_PER_TICK, leader_slices
from greywhale.loop.tables import JOINTS, PLANT_COLUMNS, check_controllers, check_plants, controllers_of, plant_row
from greywhale.protocol import schema
from greywhale.trajectory import Trajectory
from greywhale.trajectory.motion import Array

TICK_S = 1e-3
PWM_TOP = {"mega": (400, 400, 400, 400), "nano": (400, 400, 255, 255)}
LATEST_CHAIN = 7000  # cycles: a chain takes 12,944 and must end before the next tick
STEPS_PER_TICK = (1, 2, 4)
LONGEST_DELAY = 1000  # ticks


@dataclass(frozen=True)
class Timing:
    """When things happen within a tick of 1 ms, which spans four slices of 250 us and begins somewhere in the first.

    `chain_start`: cycles (16 MHz) from the beginning of that slice to the first of the tick's 32 conversions.
    `acts`: the slice (1..3) from whose beginning each joint's new voltage acts.
    `drivers_on`: the slice (1..4, of tick 0) in which the drivers are first found on; a slice later the hand lets go of
    the follower, and the controllers run from tick 1 on.
    On the bench all depend on the cycle at which the board was switched on; the defaults are those of a tick that
    begins with its slice and is done within it.
    `late`: ticks by which every duty acts later than the firmware gives it. No board does that; a controller with a
    margin bears it.
    """

    chain_start: int = 2208
    acts: tuple[int, int, int, int] = (1, 1, 1, 1)
    drivers_on: int = 1
    late: int = 0

    def __post_init__(self) -> None:
        if not 0 <= self.chain_start <= LATEST_CHAIN:
            raise UserError(
                f"chain_start is {self.chain_start}, but it must be a number of cycles in 0..{LATEST_CHAIN}."
            )
        if not 0 <= self.late <= LONGEST_DELAY:
            raise UserError(f"late is {self.late}, but it must be a number of ticks in 0..{LONGEST_DELAY}.")
        if self.drivers_on not in (1, 2, 3, 4):
            raise UserError(f"drivers_on is {self.drivers_on}, but it must name a slice from 1 to 4.")
        if len(self.acts) != JOINTS or not all(1 <= slice_number < SLICES_PER_TICK for slice_number in self.acts):
            raise UserError(f"acts is {self.acts}, but it must name a slice from 1 to 3 for each of the four joints.")

    def native(self) -> _native.LoopTiming:
        return _native.LoopTiming(start=self.chain_start, acts=self.acts, on=self.drivers_on, late=self.late)


DEFAULT_TIMING = Timing()


@dataclass(frozen=True)
class Result:
    """A row per candidate and a column per joint. Measures are taken with the true angles, e = leader - follower.

    A candidate whose motion leaves the range of numbers has `diverged` set and 1e9 in every measure.
    """

    mse: Array  # (n, 4) rad^2, mean of e^2 over the ticks
    itae: Array  # (n, 4) rad s^2, integral of weight |e|
    itau: Array  # (n, 4) V s^2, integral of weight |u|, u the voltage at the motor
    diverged: npt.NDArray[np.bool_]  # (n,)
    time_s: Array  # (rows,) of the traces
    angles: npt.NDArray[np.float32]  # (n, rows, 4) rad, the follower's
    duties: npt.NDArray[np.int16]  # (n, rows, 4) PWM compare values with their direction


class Experiment:
    """Leader, sensors and board settings, shared by all candidates; `run` simulates any number of them.

    `leader` is a motion, or angles (rad) in every slice of 250 us as float64 (slices, 4). `parameters` is a whole
    parameter table, raw, in index order; its controllers are the candidate unless others are given. `noise` False:
    quiet potentiometers. `weight_s` (ticks,) weighs |e| and |u| in ITAE and ITAU; by default the time since the leader
    may move.
    """

    def __init__(
        self,
        leader: Trajectory | Array,
        arm: ArmParameters,
        *,
        parameters: Sequence[int] = schema.DEFAULTS,
        board: Literal["mega", "nano"] = "mega",
        noise: bool = True,
        seed: int = 1,
        wait_s: float = 1.5,
        after_s: float = 0.0,
        resample: bool = False,
        soft_start: bool = True,
        weight_s: Array | None = None,
        timing: Timing = DEFAULT_TIMING,
        gap_position: Sequence[float] | None = None,
    ) -> None:
        if board not in PWM_TOP:
            raise UserError(f'board is "{board}", but it must be one of {", ".join(PWM_TOP)}.')
        self.arm = arm
        self.parameters = tuple(parameters)
        schema.check_parameters(list(self.parameters))
        if isinstance(leader, Trajectory):
            slices = leader_slices(leader, wait_s, after_s, resample)
        else:
            slices = _checked_slices(leader)
        self.ticks = len(slices) // SLICES_PER_TICK
        self.time_s: Array = np.arange(self.ticks, dtype=np.float64) * TICK_S
        settings = self._settings(board, soft_start)
        moments = timing.native()
        self.reference, self.leader = _native.leader_readings(
            settings=settings,
            timing=moments,
            pots=_pots(arm.leader_pots, noise),
            pot_supply=arm.leader_pots.supply,
            seed=seed,
            angles=slices,
        )
        self.weight_s = _checked_weight(weight_s, self.time_s, wait_s)
        self.home = slices[0].copy()
        gap = np.random.default_rng(seed).uniform(-1.0, 1.0, JOINTS) if gap_position is None else np.array(gap_position)
        self._loop = _native.ClosedLoop(
            settings=settings,
            timing=moments,
            pots=_pots(arm.follower_pots, noise),
            pot_supply=arm.follower_pots.supply,
            seed=seed + 1,
            home=[float(angle) for angle in self.home],
            gap=[float(share) for share in gap],
            reference=self.reference,
            leader=self.leader,
            weight=self.weight_s,
        )

    def run(
        self,
        controllers: npt.NDArray[np.int32] | None = None,
        plants: Array | None = None,
        *,
        every: int = 0,
        threads: int = 0,
        steps_per_tick: int = 2,
        instructions: str = "",
    ) -> Result:
        """Simulate a batch: controllers int32 (n, 4, 12), plants float64 (n, 60), or one row of either for all.

        Sixteen candidates at a time in single precision, on `threads` threads (0: one per core); the result does not
        depend on their number. `every` > 0 keeps angles and duties of every so many ticks. `steps_per_tick` 1, 2 or 4
        trades speed for accuracy: docs/closed_loop.md has the errors.
        """
        if steps_per_tick not in STEPS_PER_TICK:
            raise UserError(f"steps_per_tick is {steps_per_tick}, but it must be 1, 2 or 4.")
        return self._run(controllers, plants, every, threads, steps_per_tick, False, instructions)

    def run_single(
        self,
        controllers: npt.NDArray[np.int32] | None = None,
        plants: Array | None = None,
        *,
        every: int = 0,
        threads: int = 0,
        steps_per_slice: int = 1,
    ) -> Result:
        """The same one by one in double precision, as the bench does it, bit for bit; finer steps give a reference."""
        if steps_per_slice < 1:
            raise UserError(f"steps_per_slice is {steps_per_slice}, but it must be 1 or more.")
        return self._run(controllers, plants, every, threads, steps_per_slice, True, "")

    def _run(
        self,
        controllers: npt.NDArray[np.int32] | None,
        plants: Array | None,
        every: int,
        threads: int,
        substeps: int,
        single: bool,
        instructions: str,
    ) -> Result:
        laws = check_controllers(controllers_of(self.parameters) if controllers is None else controllers)
        rows = check_plants(plant_row(self.arm) if plants is None else plants)
        if len(laws) != len(rows) and 1 not in (len(laws), len(rows)):
            raise UserError(
                f"there are {len(laws)} controllers and {len(rows)} plants; give as many, or one of either."
            )
        self._require_home(rows)
        if every < 0 or threads < 0:
            raise UserError(f"every is {every} and threads is {threads}, but neither may be negative.")
        try:
            mse, itae, itau, diverged, angles, duties = self._loop.run(
                controllers=laws,
                plants=rows,
                substeps=substeps,
                threads=threads,
                every=every,
                single=single,
                instructions=instructions,
            )
        except ValueError as error:
            raise UserError(str(error)) from None
        time_s = self.time_s[::every] if every else self.time_s[:0]
        return Result(mse, itae, itau, diverged, time_s, angles, duties)

    def _require_home(self, plants: Array) -> None:
        for joint, angle in enumerate(self.home):
            low, high = (PLANT_COLUMNS.index(f"joint{joint}.stop_{side}") for side in ("min", "max"))
            outside = np.flatnonzero((plants[:, low] > angle) | (plants[:, high] < angle))
            if outside.size:
                row = int(outside[0])
                raise UserError(
                    f"the leader starts with joint {joint} at {angle:g} rad, beyond the follower's stops of "
                    f"plants[{row}], {plants[row, low]:g} to {plants[row, high]:g} rad."
                )

    def _settings(self, board: str, soft_start: bool) -> _native.LoopSettings:
        def value(name: str) -> int:
            return self.parameters[schema.PARAMETER_BY_NAME[name].index]

        def four(group: str, key: str) -> list[int]:
            return [value(f"{group}{joint}.{key}") for joint in range(JOINTS)]

        return _native.LoopSettings(
            period_ms=value("period_ms"),
            supply_mv=value("supply_mv"),
            soft_start_ms=value("soft_start_ms") if soft_start else 0,
            filter_shift=value("filter_shift"),
            limit_min=four("joint", "limit_min"),
            limit_max=four("joint", "limit_max"),
            motor_sign=four("joint", "motor_sign"),
            pwm_top=PWM_TOP[board],
            leader_zero=four("leader", "zero"),
            leader_scale=four("leader", "scale"),
            follower_zero=four("follower", "zero"),
            follower_scale=four("follower", "scale"),
        )


def _pots(bank: PotentiometerBank, noise: bool) -> list[_native.Potentiometer]:
    return [
        _native.Potentiometer(
            track=pot.track,
            centre=pot.centre,
            direction=pot.direction,
            noise=pot.noise if noise else 0.0,
            linearity=pot.linearity,
        )
        for pot in bank.joint
    ]


def _checked_slices(slices: Array) -> Array:
    if not isinstance(slices, np.ndarray) or slices.dtype != np.float64:
        raise UserError("the leader must be a Trajectory, or a numpy array of float64 angles in every slice of 250 us.")
    if slices.ndim != 2 or slices.shape[1] != JOINTS or len(slices) < SLICES_PER_TICK or len(slices) % SLICES_PER_TICK:
        raise UserError(f"the leader's angles have the shape {slices.shape}, but (4 x ticks, 4) is needed.")
    if not np.isfinite(slices).all():
        row, joint = (int(index) for index in np.argwhere(~np.isfinite(slices))[0])
        raise UserError(
            f"the leader's angle of joint {joint} in slice {row} is {slices[row, joint]}; it must be finite."
        )
    return np.ascontiguousarray(slices)


def _checked_weight(weight: Array | None, time_s: Array, wait_s: float) -> Array:
    if weight is None:
        since: Array = np.maximum(time_s - wait_s, 0.0)
        return since
    if not isinstance(weight, np.ndarray) or weight.dtype != np.float64 or weight.shape != time_s.shape:
        raise UserError(
            f"weight_s must be a numpy array of float64 with one weight for each of the {len(time_s)} ticks."
        )
    if not np.isfinite(weight).all():
        raise UserError("weight_s holds a weight that is not a finite number.")
    return np.ascontiguousarray(weight)
