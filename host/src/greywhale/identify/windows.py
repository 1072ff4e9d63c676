"""The first residual: the logged voltages drive candidate arms over short windows, and the log gives each start.

The start of a window is known only as well as the potentiometers are read. So angle and speed there are free within
their uncertainty. A formula finds the best ones for every window and candidate, because the error that they cause is
nearly linear in them. That keeps the residual smooth in the parameters, and fair.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from copy import copy
from dataclasses import replace
from functools import cached_property

import numpy as np
from numpy.typing import NDArray

from greywhale import _native
from greywhale.arm import ArmParameters
from greywhale.arm.body import Body
from greywhale.arm.plants import column, plant_row
from greywhale.base.types import Floats
from greywhale.identify.data import STEP_S, Prepared, Windows, in_brief, part_of, some_windows, windows_of
from greywhale.identify.limits import IDENTIFICATION_LIMITS, DataLimits
from greywhale.identify.space import Space
from greywhale.protocol.firmware import JOINTS

# The places at which a motor may stand in its gap at a window's start, or a joint in its potentiometer's play.
# They are shares of half of it.
SIDES = (-1.0, -0.5, 0.0, 0.5, 1.0)
# The formula for starts is linear, the gap is not.
START_PASSES = 2


class WindowResidual:
    """Differences between log and candidates, in standard deviations of a reading; one row of numbers a candidate."""

    def __init__(
        self,
        logs: Sequence[Prepared],
        arm: ArmParameters,
        joints: Sequence[int],
        held_out: bool | None = None,
        every: int = 1,
        longest_step: float = STEP_S,
    ) -> None:
        """At most about so many windows of the logs as their limits say, those held out or the others; of these, one in
        `every`.
        """
        self._in_brief: Callable[[], WindowResidual] = lambda: WindowResidual(
            [in_brief(log) for log in logs], arm, joints, held_out, every, longest_step
        )
        self.joints = list(joints)
        self.limits = logs[0].limits if logs else IDENTIFICATION_LIMITS
        data = self.limits.data
        self._body = Body.of(plant_row(arm))
        parts = [_part(numbers, held_out, every, data) for numbers in some_windows(logs, data.max_windows)]
        self._pieces = [(windows_of(log, part, longest_step), log) for part, log in zip(parts, logs, strict=True)]
        self._pieces = [piece for piece in self._pieces if len(piece[0].first)]
        self._logged = tuple(self._pieces)
        self._sides = [self._sides_of(*piece) for piece in self._pieces]
        self._places: dict[int, Floats] = {}  # of the pieces for which they were chosen anew
        self.windows = sum(len(windows.first) for windows, _ in self._pieces)
        self.seconds = sum(len(windows.first) * windows.rows * log.period for windows, log in self._pieces)
        self.clusters, self.joint_of = self._places_of_numbers()

    @cached_property
    def brief(self) -> WindowResidual:
        """These logs in the short windows that gears are fitted to."""
        return self._in_brief()

    def copy(self) -> WindowResidual:
        """Return these windows again, with starts that can be chosen apart from theirs."""
        other = copy(self)
        other._pieces, other._sides, other._places = list(self._pieces), list(self._sides), dict(self._places)
        other.__dict__.pop("brief", None)
        return other

    def __call__(self, space: Space, points: Floats) -> Floats:
        """(candidates, numbers)."""
        plants = np.ascontiguousarray(space.plants(points))
        offsets = np.ascontiguousarray(space.offsets(points))
        parts = [
            self._compare(windows, log, sides, plants, offsets)
            for (windows, log), sides in zip(self._pieces, self._sides, strict=True)
        ]
        return np.concatenate(parts, axis=1)

    def settle(self, plant: Floats, zero: Floats) -> bool:
        """Choose anew, for this plant, the start of each window that fits the log best. True if a motor changed its
        place.

        A start is an angle, a speed, the motor's place in its gap and the joint's in its potentiometer's play. Where a
        joint hunts in its gap, torques show that place badly, and a window that starts on the wrong side is useless.
        """
        changed = False
        # Start from the log's own values again: those of another model would stay where that model wanted them.
        self._pieces = list(self._logged)
        for number in range(len(self._pieces)):
            if any(plant[column("half_gap", joint)] > 0.0 for joint in self.joints):
                changed = self._settle_sides(number, plant, zero) or changed
            if any(plant[column("pot_play", joint)] > 0.0 for joint in self.joints):
                changed = self._settle_places(number, plant, zero) or changed
            for _ in range(START_PASSES):
                self._settle_starts(number, plant, zero)
        return changed

    def _settle_sides(self, number: int, plant: Floats, zero: Floats) -> bool:
        windows, log = self._pieces[number]
        tried = np.array([self._sides[number], *(np.full_like(windows.angles, side) for side in SIDES)])
        costs = self._costs(windows.repeated(len(tried)), log, tried.reshape(-1, JOINTS), plant, zero)[0]
        self._sides[number], changed = _choose(tried, costs.reshape(tried.shape), self.limits.windows.worth_a_change)
        return changed

    def _settle_places(self, number: int, plant: Floats, zero: Floats) -> bool:
        """Choose the joint's place in the play of its potentiometer at each window's start. True where one changed."""
        windows, log = self._pieces[number]
        sides = self._sides[number]
        known = self._places.get(number, windows.places)
        tried = np.array([known, *(np.full_like(windows.angles, side) for side in SIDES)])
        ways = replace(windows.repeated(len(tried)), places=tried.reshape(-1, JOINTS))
        costs = self._costs(ways, log, np.tile(sides, (len(tried), 1)), plant, zero)[0]
        self._places[number], changed = _choose(tried, costs.reshape(tried.shape), self.limits.windows.worth_a_change)
        self._pieces[number] = replace(windows, places=self._places[number]), log
        return changed

    def _settle_starts(self, number: int, plant: Floats, zero: Floats) -> None:
        """Move starts by the formula's correction, where the simulation agrees that this is better."""
        windows, log = self._pieces[number]
        sides = self._sides[number]
        before, angles, velocities = self._costs(windows, log, sides, plant, zero)
        moved = replace(
            windows,
            angles=np.ascontiguousarray(windows.angles - angles),
            velocities=np.ascontiguousarray(windows.velocities - velocities),
        )
        better = self._costs(moved, log, sides, plant, zero)[0] < before
        kept = replace(
            windows,
            angles=np.where(better, moved.angles, windows.angles),
            velocities=np.where(better, moved.velocities, windows.velocities),
        )
        self._pieces[number] = kept, log

    def _costs(
        self, windows: Windows, log: Prepared, sides: Floats, plant: Floats, zero: Floats
    ) -> tuple[Floats, Floats, Floats]:
        """Squared difference (windows, 4) of one plant without the part that its best starts explain, and these: rad,
        rad/s.
        """
        error = self._errors(windows, sides, plant[None], zero[None])
        count = len(windows.first)
        costs, angles, velocities = (np.zeros((count, JOINTS)) for _ in range(3))
        for joint in self.joints:
            left = take_off_starts(error[..., joint], windows, log, plant[None], joint)[0]
            readings, starts = np.split(left, [windows.measured[..., 0].size])
            costs[:, joint] = np.sum(readings.reshape(count, -1) ** 2, axis=1)
            costs[:, joint] += np.sum(starts.reshape(2, -1) ** 2, axis=0)
            angles[:, joint] = starts[:count] * log.noise[joint]
            velocities[:, joint] = starts[count:] * self.limits.windows.speed_doubt_rad_s
        return costs, angles, velocities

    def settled_error(self, plant: Floats, zero: Floats) -> Floats:
        """Choose the starts for this plant; the mean over windows of log(1 + squares over noise) (joints,) it leaves.

        The logarithm keeps one motion that is missing in the fitted part from outweighing all other motions.
        """
        self.settle(plant, zero)
        errors: Floats = np.mean(np.log1p(self.misfit(plant, zero)), axis=0)
        return errors

    def misfit(self, plant: Floats, zero: Floats) -> Floats:
        """Squares per reading over the noise's (windows, joints) of one plant, computed as in `mse`."""
        parts = [
            self._costs(windows, log, sides, plant, zero)[0] / len(windows.time)
            for (windows, log), sides in zip(self._pieces, self._sides, strict=True)
        ]
        return np.concatenate(parts)[:, self.joints]

    def mse(self, plant: Floats, zero: Floats) -> Floats:
        """Mean squared difference per joint, rad², of one plant, without the part that the best start of a window
        explains.
        """
        total, count = np.zeros(4), 0
        for (windows, log), sides in zip(self._pieces, self._sides, strict=True):
            error = self._errors(windows, sides, plant[None], zero[None])
            for joint in self.joints:
                left = take_off_starts(error[..., joint], windows, log, plant[None], joint)[0]
                total[joint] += log.noise[joint] ** 2 * float(np.sum(left[: windows.measured[..., 0].size] ** 2))
            count += windows.measured[..., 0].size
        return total / max(count, 1)

    def _compare(self, windows: Windows, log: Prepared, sides: Floats, plants: Floats, offsets: Floats) -> Floats:
        error = self._errors(windows, sides, plants, offsets)
        rows = [take_off_starts(error[..., joint], windows, log, plants, joint) for joint in self.joints]
        return np.concatenate(rows, axis=1)

    @staticmethod
    def _errors(windows: Windows, sides: Floats, plants: Floats, offsets: Floats) -> Floats:
        """Candidates minus log, (candidates, windows, rows, 4), rad."""
        angles: Floats = _native.simulate_windows(  # type: ignore[assignment] # the stub says object
            plants=plants,
            offsets=offsets,
            first=windows.first,
            angles=windows.angles,
            velocities=windows.velocities,
            sides=sides,
            places=windows.places,
            led=windows.led,
            log_angles=windows.log_angles,
            log_velocities=windows.log_velocities,
            log_places=windows.log_places,
            rows=windows.rows,
            volts=windows.volts,
            spacing=windows.spacing,
            substeps=windows.substeps,
            every=windows.every,
        )
        error: Floats = angles - windows.measured[None]
        # A sum is quicker than a look at every number; it is finite where all of them are.
        return error if np.isfinite(error.sum()) else np.nan_to_num(error, nan=1e3, posinf=1e3, neginf=-1e3)

    def _places_of_numbers(self) -> tuple[NDArray[np.intp], NDArray[np.intp]]:
        """The window, counted over all logs, and the joint that each number of the residual belongs to."""
        clusters, joints = [np.zeros(0, dtype=np.intp)], [np.zeros(0, dtype=np.intp)]
        before = 0
        for windows, _ in self._pieces:
            number = before + np.arange(len(windows.first))
            numbers = np.concatenate([np.repeat(number, len(windows.time)), number, number])
            clusters += [numbers] * len(self.joints)
            joints += [np.full(len(numbers), joint) for joint in self.joints]
            before += len(windows.first)
        return np.concatenate(clusters), np.concatenate(joints)

    def _sides_of(self, windows: Windows, log: Prepared) -> Floats:
        """Return the teeth that touch where the log begins to lead: those that give the torque that the links take."""
        at = windows.first - windows.led
        torque = self._body.torque(log.smooth[at], log.velocity[at], log.acceleration[at])
        still = (np.abs(torque) < 1e-3) & (np.abs(log.velocity[at]) < 0.05)
        sides: Floats = np.where(still, 0.0, np.sign(torque))
        return sides


def _choose(tried: Floats, costs: Floats, worth_a_change: float) -> tuple[Floats, bool]:
    """For each window and joint the best of (tries, windows, 4); the first stays unless another is clearly better."""
    best = np.where(np.min(costs, axis=0) < worth_a_change * costs[0], np.argmin(costs, axis=0), 0)
    chosen: Floats = np.ascontiguousarray(np.take_along_axis(tried, best[None], axis=0)[0])
    return chosen, bool(np.any(best))


def take_off_starts(error: Floats, windows: Windows, log: Prepared, plants: Floats, joint: int) -> Floats:
    """Take the best start angle and speed of every window off its error; their sizes become residuals of their own.

    `error` of one joint is (candidates, windows, rows) in rad. The result is (candidates, numbers) in standard
    deviations: every row of every window, then the start angles and the start speeds of the windows.
    """
    noise = log.noise[joint]
    count = len(error)
    lag = (plants[:, column("inertia", joint)] / plants[:, column("damping", joint)])[:, None]
    speed = lag * -np.expm1(-windows.time[None, :] / lag)
    basis = np.stack([np.ones_like(speed), speed], axis=1)  # (n, 2, rows)
    doubt = np.array([noise, log.limits.windows.speed_doubt_rad_s])
    normal = basis @ basis.transpose(0, 2, 1) / noise**2 + np.diag(1.0 / doubt**2)
    right = basis @ error.transpose(0, 2, 1) / noise**2
    best = np.linalg.solve(normal, right)  # (n, 2, windows)
    left = (error - best.transpose(0, 2, 1) @ basis) / noise
    return np.concatenate([left.reshape(count, -1), (best / doubt[None, :, None]).reshape(count, -1)], axis=1)


def _part(numbers: NDArray[np.intp], held_out: bool | None, every: int, limits: DataLimits) -> NDArray[np.intp]:
    if held_out is not None:
        per_block = round(limits.block_s / limits.window_s)
        numbers = numbers[part_of(len(numbers), per_block, held_out, limits.held_out_every)]
    return numbers[::every]
