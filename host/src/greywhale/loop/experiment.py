"""One experiment with the closed loop: what all candidates share, and a result for each."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
import numpy.typing as npt

from greywhale.arm import ArmParameters
from greywhale.arm.plants import check_plants, column, plant_row
from greywhale.base.errors import UserError
from greywhale.base.types import Floats
from greywhale.files.trajectory import Trajectory
from greywhale.loop.closed_loop import (
    DEFAULT_TIMING,
    ClosedLoop,
    FollowerLines,
    Readings,
    Result,
    Timing,
    read_leader,
    with_right_motors,
)
from greywhale.loop.controllers import check_controllers, controllers_of
from greywhale.loop.leader import SLICES_PER_TICK, leader_slices
from greywhale.protocol.firmware import JOINTS, TICK_S
from greywhale.protocol.joints import unused
from greywhale.protocol.table import ParameterTable


class Experiment:
    """Leader, sensors and board settings, shared by all candidates; `run` simulates any number of them.

    `leader` is a motion, or angles (rad) in every slice of 250 us as float64 (slices, 4); joints that the arm does not
    use stay at 0. `table` is the parameter table of the board; its controllers are the candidate unless others are
    given, and its motors turn as the arm's, whatever their wires. With `noise` False the potentiometers are quiet.
    `weight_s` (ticks,) weighs the sizes of e and u in ITAE and ITAU; by default it is the time since the leader may
    move. The attribute `leader` is the follower's angle that reads as the leader does; there the follower starts.
    """

    def __init__(
        self,
        leader: Trajectory | Floats,
        arm: ArmParameters,
        *,
        table: ParameterTable | None = None,
        noise: bool = True,
        seed: int = 1,
        wait_s: float = 1.5,
        resample: bool = False,
        soft_start: bool = True,
        weight_s: Floats | None = None,
        timing: Timing = DEFAULT_TIMING,
        gap_position: Sequence[float] | None = None,
        instructions: str = "",
    ) -> None:
        self.arm = arm
        self.table = ParameterTable.defaults() if table is None else table
        if isinstance(leader, Trajectory):
            slices = leader_slices(leader, wait_s, resample)
        else:
            slices = _check_slices(leader).copy()
        slices[:, unused(arm.joints_in_use)] = 0.0
        self.lines = FollowerLines.of(arm, self.table)
        readings = read_leader(self.table, arm.leader_pots, slices, seed=seed, noise=noise, timing=timing)
        readings = Readings(readings.reference, np.ascontiguousarray(self.lines.follower(readings.leader)))
        self.reference, self.leader = readings.reference, readings.leader
        self.home = self.leader[0].copy()
        time_s = np.arange(len(self.leader), dtype=np.float64) * TICK_S
        self.weight_s = _check_weight(weight_s, time_s, wait_s)
        gap = np.random.default_rng(seed).uniform(-1.0, 1.0, JOINTS) if gap_position is None else np.array(gap_position)
        self._loop = ClosedLoop(
            with_right_motors(self.table),
            readings,
            arm.follower_pots,
            seed=seed + 1,
            home=self.home.tolist(),
            gap=gap.tolist(),
            weight_s=self.weight_s,
            noise=noise,
            timing=timing,
            soft_start=soft_start,
            instructions=instructions,
        )
        self.time_s = self._loop.time_s
        self.ticks = self._loop.ticks

    def run(
        self,
        controllers: npt.NDArray[np.int32] | None = None,
        plants: Floats | None = None,
        *,
        every: int = 0,
        threads: int = 0,
        steps_per_tick: int = 2,
    ) -> Result:
        """Simulate a batch: controllers int32 (n, 4, 13), plants float64 (n, columns), or one row of either for all.

        Sixteen candidates run at a time in single precision, on `threads` threads (0: one per core); the result does
        not depend on their number. `every` > 0 keeps angles and duties of every so many ticks. `steps_per_tick` 1, 2 or
        4 trades speed for accuracy: docs/closed_loop.md has the errors.
        """
        if steps_per_tick not in (1, 2, 4):
            raise UserError(f"steps_per_tick is {steps_per_tick}, but it must be 1, 2 or 4.")
        return self._run(controllers, plants, every, threads, steps_per_tick, False)

    def run_exact(
        self,
        controllers: npt.NDArray[np.int32] | None = None,
        plants: Floats | None = None,
        *,
        every: int = 0,
        threads: int = 0,
        steps_per_slice: int = 1,
    ) -> Result:
        """Simulate one by one in double precision, as the bench does, bit for bit; finer steps give a reference."""
        if steps_per_slice < 1:
            raise UserError(f"steps_per_slice is {steps_per_slice}, but it must be 1 or more.")
        return self._run(controllers, plants, every, threads, steps_per_slice, True)

    def _run(
        self,
        controllers: npt.NDArray[np.int32] | None,
        plants: Floats | None,
        every: int,
        threads: int,
        substeps: int,
        exact: bool,
    ) -> Result:
        laws = check_controllers(controllers_of(self.table) if controllers is None else controllers)
        rows = check_plants(plant_row(self.arm) if plants is None else plants)
        if len(laws) != len(rows) and 1 not in (len(laws), len(rows)):
            raise UserError(
                f"there are {len(laws)} controllers and {len(rows)} plants; give as many, or one of either."
            )
        self._require_home(rows)
        if every < 0 or threads < 0:
            raise UserError(f"every is {every} and threads is {threads}, but neither may be negative.")
        return self._loop.run(
            laws,
            rows,
            substeps=substeps,
            every=every,
            threads=threads,
            exact=exact,
        )

    def _require_home(self, plants: Floats) -> None:
        for joint, angle in enumerate(self.home):
            low, high = (column(f"stop_{side}", joint) for side in ("min", "max"))
            outside = np.flatnonzero((plants[:, low] > angle) | (plants[:, high] < angle))
            if outside.size:
                row = int(outside[0])
                raise UserError(
                    f"the leader starts with joint {joint} at {angle:g} rad, beyond the follower's stops of "
                    f"plants[{row}], {plants[row, low]:g} to {plants[row, high]:g} rad."
                )


def _check_slices(slices: Floats) -> Floats:
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


def _check_weight(weight: Floats | None, time_s: Floats, wait_s: float) -> Floats:
    if weight is None:
        return np.maximum(time_s - wait_s, 0.0)
    if not isinstance(weight, np.ndarray) or weight.dtype != np.float64 or weight.shape != time_s.shape:
        raise UserError(
            f"weight_s must be a numpy array of float64 with one weight for each of the {len(time_s)} ticks."
        )
    if not np.isfinite(weight).all():
        raise UserError("weight_s holds a weight that is not a finite number.")
    return np.ascontiguousarray(weight)
