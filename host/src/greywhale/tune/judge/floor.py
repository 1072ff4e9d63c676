"""The saturation floor of a motion: the least error that the supply allows to any controller, however good.

A motor has only so much voltage, so an arm cannot jump when its leader does, and no tuning can change that. Two numbers
enclose the best that is possible, per joint (both in rad^2, over the window of `Experiment(motion)`):

- `mse`, the floor, is reached by an ideal controller in the arm simulation, with its friction, gaps and couplings. That
  controller knows plant and state without noise, delay or quantisation, acts every 250 us, and follows the braking
  curve of each joint (host/native/ideal/law.h). It is causal: it knows the leader's angle and speed only up to this
  moment. Its law leaves some numbers open (when to brake, how to settle). A search on the motion itself finds those
  with the least total.
- `bound` is a lower limit: no controller that waits at the leader while the leader rests gets below it, however it then
  moves that joint. From the moment the leader leaves, the joint runs after it at full voltage, without a gap to cross
  and without ever having to brake. Only the way that the leader is ahead of this joint counts. The other joints move as
  under the ideal controller. The bound is 0, and says nothing, for leaders that never rest or that a motor can keep up
  with.

For steps the floor lies 0.1 to 1.3 % above the bound on the shipped arms. An optimiser over the voltages themselves,
which knows what the leader will do, gains less than 1 % on it (tests/oracles/test_floor.py). 64 fuzzy controllers were
tried on each of 14 random arms, and none came below the total on multi-steps. One joint's share came out up to 3 %
lower where its neighbour moved differently and carried it. Where nothing saturates, the floor is some mrad of backlash,
a multiple of it means nothing, and `multiple` gives None.
"""

from __future__ import annotations

import itertools
from dataclasses import dataclass, field

import numpy as np
from numpy.typing import NDArray

from greywhale import _native
from greywhale.arm import ArmParameters
from greywhale.arm.plants import check_plants, column, rigid_joints
from greywhale.base.errors import BadUsage
from greywhale.base.types import Floats
from greywhale.files.trajectory import Trajectory
from greywhale.loop import leader_slices, plant_row
from greywhale.loop.leader import SLICE_S, SLICES_PER_TICK
from greywhale.measure.runs import resting
from greywhale.protocol.firmware import JOINTS
from greywhale.tune.limits import TUNING_LIMITS, FloorLimits


@dataclass(frozen=True)
class Floor:
    """See above; `angles` are the ideal controller's, at every tick of 1 ms as `leader`."""

    mse: Floats  # (4,) rad^2
    bound: Floats  # (4,) rad^2
    time_s: Floats = field(repr=False)  # (ticks,)
    leader: Floats = field(repr=False)  # (ticks, 4) rad
    angles: Floats = field(repr=False)  # (ticks, 4) rad
    limits: FloorLimits = field(default=TUNING_LIMITS.floor, repr=False)

    @property
    def total(self) -> float:
        return float(self.mse.sum())

    @property
    def limited(self) -> tuple[bool, ...]:
        """For each joint, then for all: whether the supply keeps the error from zero."""
        each = [*zip(self.mse, self.bound, strict=True), (self.mse.sum(), self.bound.sum())]
        backlash, tellable = self.limits.backlash_rad2, self.limits.tellable_rad2
        return tuple(bool(floor >= backlash or 2.0 * bound >= floor >= tellable) for floor, bound in each)

    def multiple(self, mse: Floats) -> tuple[float | None, ...]:
        """Each joint's error as a multiple of the floor, then the total's; None where the supply does not limit it."""
        each = zip([*mse, mse.sum()], [*self.mse, self.mse.sum()], self.limited, strict=True)
        return tuple(float(one / floor) if limited else None for one, floor, limited in each)


def saturation_floor(
    motion: Trajectory | Floats,
    arm: ArmParameters | Floats,
    *,
    delay_s: float = 0.0,
    wait_s: float = 1.5,
    resample: bool = False,
    threads: int = 0,
    limits: FloorLimits = TUNING_LIMITS.floor,
) -> Floor:
    """The floor of a motion (or angles in every slice of 250 us) on an arm or a plant row (columns,).

    `delay_s` says how late the controller learns where the leader is; it separates the cost of sensing from the cost of
    the supply. The rest is as in Experiment.
    """
    loop = _loop_of(motion, arm, delay_s, wait_s, resample, threads)
    tunings = _best(loop, limits)
    mse, angles = loop.run(tunings[None], keep=True)
    bound = np.array([_bound(loop, joint, tunings, limits) for joint in range(JOINTS)])
    time_s: Floats = np.arange(len(loop.leader), dtype=np.float64) * SLICE_S * SLICES_PER_TICK
    return Floor(mse[0], bound, time_s, loop.leader, angles[0], limits)


def follow_ideally(
    motion: Trajectory,
    plants: Floats,
    *,
    delay_s: float,
    wait_s: float,
    threads: int = 0,
    limits: FloorLimits = TUNING_LIMITS.floor,
) -> tuple[Floats, Floats]:
    """The leader's angles (ticks, 4) and the ideal controller's (plants, ticks, 4) in rad, as of `saturation_floor`.

    The law's open numbers are those of the first plant.
    """
    loops = [_loop_of(motion, plant, delay_s, wait_s, False, threads) for plant in plants]
    tunings = _best(loops[0], limits)[None]
    return loops[0].leader, np.stack([loop.run(tunings, keep=True)[1][0] for loop in loops])


def _loop_of(
    motion: Trajectory | Floats,
    arm: ArmParameters | Floats,
    delay_s: float,
    wait_s: float,
    resample: bool,
    threads: int,
) -> _Loop:
    plant = check_plants(arm if isinstance(arm, np.ndarray) else plant_row(arm))
    if len(plant) != 1:
        raise BadUsage(f"the floor is of one plant, not of {len(plant)}; call it for each.")
    slices = leader_slices(motion, wait_s, resample) if isinstance(motion, Trajectory) else _checked(motion)
    slices = np.where(rigid_joints(plant[0]), 0.0, slices)  # what is not in use is not led
    loop = _Loop(slices, plant[0], _delay_slices(delay_s), threads)
    _require_reach(loop)
    return loop


@dataclass(frozen=True)
class _Loop:
    """The arm under the ideal controller."""

    slices: Floats  # (slices, 4) rad
    plant: Floats
    late: int  # slices
    threads: int

    @property
    def leader(self) -> Floats:
        return np.ascontiguousarray(self.slices[::SLICES_PER_TICK])

    def run(self, tunings: Floats, keep: bool = False) -> tuple[Floats, Floats]:
        """Errors (n, 4) and, to keep, angles (n, ticks, 4) for tunings (n, 4, 4)."""
        nowhere = np.zeros(len(self.slices))
        return self._simulate(self.plant, tunings, -1, nowhere.astype(np.int8), nowhere, keep)

    def chase(self, joint: int, tunings: Floats, direction: NDArray[np.int8], until: Floats) -> Floats:
        """A joint's angles (ticks,) at full voltage in `direction` as far as `until`, its gear without a gap."""
        tight = self.plant.copy()
        tight[column("half_gap", joint)] = 0.0
        return self._simulate(tight, tunings[None], joint, direction, until, True)[1][0, :, joint]

    def _simulate(
        self, plant: Floats, tunings: Floats, chased: int, direction: NDArray[np.int8], until: Floats, keep: bool
    ) -> tuple[Floats, Floats]:
        """The joint `chased` (-1: none) runs at full voltage in `direction` (slices,) as far as `until` (rad)."""
        mse, angles = _native.simulate_ideal(
            leader=self.slices,
            late=self.late,
            plant=plant,
            supply=float(plant[column("supply")]),
            tunings=tunings,
            chased=chased,
            direction=direction,
            until=until,
            keep=keep,
            threads=self.threads,
        )
        return mse, angles


def _best(loop: _Loop, limits: FloorLimits) -> Floats:
    """The tunings (4, 4) of least total error. The ideal law's open numbers are brake (share), settle (s), lead (share)
    and pull (share); see host/native/ideal/law.h.
    """
    grid = list(itertools.product((1.0,), limits.tried_settling_s, (0.0, 1.0), (0.0, 1.0)))
    tried = np.repeat(np.array(grid)[:, None, :], JOINTS, axis=1)
    totals = loop.run(tried)[0].sum(axis=1)
    best: Floats = tried[totals.argmin()]
    least = totals.min()
    rigid = rigid_joints(loop.plant)
    # The pitch joints pull at each other most, so they go first.
    for joint in (1, 2, 0, 3) if least > limits.backlash_rad2 else ():
        if rigid[joint]:
            continue
        tried = np.repeat(best[None], len(limits.tried_brakes), axis=0)
        tried[:, joint, 0] = limits.tried_brakes
        totals = loop.run(tried)[0].sum(axis=1)
        if totals.min() < least:
            best, least = tried[totals.argmin()], totals.min()
    return best


@dataclass(frozen=True)
class _Move:
    """A joint's leader from when it leaves a rest to its next rest: ticks, the angle it left, its direction."""

    start: int
    stop: int
    origin: float
    side: int  # +1 or -1
    furthest: float


def _moves(leader: Floats, limits: FloorLimits) -> list[_Move]:
    """The moves of one joint out of a rest."""
    window = round(limits.rest_s / (SLICE_S * SLICES_PER_TICK))
    rest = resting(leader, window, limits.rest_rad)
    departures = []
    for left in np.flatnonzero(rest[:-1] & ~rest[1:]) + 1:
        origin = float(np.median(leader[left - window : left]))
        side = 1 if leader[left] > origin else -1
        # The leader has already gone a little when it leaves the band, so the move starts where it last was at its
        # rest.
        departures.append((int(np.flatnonzero(side * (leader[:left] - origin) <= 0.0)[-1]), origin, side))
    ends = [*(start for start, _, _ in departures[1:]), len(leader)] if departures else []
    return [
        _Move(start, stop, origin, side, float(side * (side * leader[start:stop]).max()))
        for (start, origin, side), stop in zip(departures, ends, strict=True)
        if stop > start
    ]


def _bound(loop: _Loop, joint: int, tunings: Floats, limits: FloorLimits) -> float:
    """The squared way that the leader is ahead of a joint at full voltage, over all moves; see the head."""
    leader = loop.leader[:, joint]
    moves = _moves(leader, limits)
    direction, until = np.zeros(len(leader), dtype=np.int8), np.zeros(len(leader))
    stops = [loop.plant[column(f"stop_{side}", joint)] for side in ("min", "max")]
    for move in moves:
        direction[move.start : move.stop] = move.side
        until[move.start : move.stop] = np.clip(move.furthest, *stops)
    if not moves:
        return 0.0
    late = loop.late // SLICES_PER_TICK  # rounded down: the joint may leave earlier, which only lowers the bound
    each = np.repeat(np.roll(direction, late), SLICES_PER_TICK), np.repeat(np.roll(until, late), SLICES_PER_TICK)
    angles = loop.chase(joint, tunings, *each)
    return sum(_sum_lead(move, leader, angles, limits) for move in moves) / len(leader)


def _sum_lead(move: _Move, leader: Floats, angles: Floats, limits: FloorLimits) -> float:
    """The sum of squares (rad^2) by which the leader of one move is ahead; 0 where the joint was not waiting for it."""
    start = move.start
    speed = (angles[start] - angles[start - 1]) / (SLICE_S * SLICES_PER_TICK) if start else 0.0
    if abs(angles[start] - move.origin) > limits.waiting_rad or abs(speed) > limits.waiting_rad_s:
        return 0.0
    run = angles[start : move.stop] - angles[start] + move.origin
    there = np.flatnonzero(move.side * (run - move.furthest) >= 0.0)
    ahead = move.side * (leader[start : move.stop] - run)
    return float((np.maximum(ahead[: there[0] if there.size else None], 0.0) ** 2).sum())


def _checked(slices: Floats) -> Floats:
    if slices.ndim != 2 or slices.shape[1] != JOINTS or not len(slices) or len(slices) % SLICES_PER_TICK:
        raise BadUsage(f"the leader has the shape {slices.shape}, but (4 x ticks, 4) is needed.")
    if not np.isfinite(slices).all():
        raise BadUsage("the leader holds an angle that is not a finite number.")
    return np.ascontiguousarray(slices, dtype=np.float64)


def _delay_slices(delay_s: float) -> int:
    if not 0.0 <= delay_s <= 1.0:
        raise BadUsage(f"delay_s is {delay_s:g}, but it must lie within 0..1 s.")
    return round(delay_s / SLICE_S)


def _require_reach(loop: _Loop) -> None:
    for joint, angle in enumerate(loop.slices[0]):
        low, high = (loop.plant[column(f"stop_{side}", joint)] for side in ("min", "max"))
        if not low <= angle <= high:
            raise BadUsage(
                f"the leader starts with joint {joint} at {angle:g} rad, beyond the follower's stops, "
                f"{low:g} to {high:g} rad; shift the motion."
            )
