"""The second residual: candidate arms inside the controller that made the log; the logged leader leads them.

The start of a window cannot mislead it. It also measures what a model is for: the response of the closed loop.
"""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
from numpy.typing import NDArray

from greywhale.arm import ArmParameters, PotentiometerBank
from greywhale.arm.limits import DOUBTS
from greywhale.arm.parameters import Potentiometer
from greywhale.base.types import Floats
from greywhale.identify.data import Prepared, at, part_of, pot_noise
from greywhale.identify.space import Space
from greywhale.loop.closed_loop import ClosedLoop, known_readings, shown_angles, with_ideal_follower
from greywhale.loop.controllers import controllers_of
from greywhale.loop.led_model import LEAD_TICKS
from greywhale.protocol.firmware import JOINTS, TICK_S
from greywhale.protocol.table import ParameterTable

COMPARED_TICKS = 5  # from one compared row to the next
STEPS_PER_TICK = 2  # of the plant, in a search
BENCH_STEPS = 4  # of the plant in a tick, as on the bench
SEED = 1  # of the noise


class Loop:
    """The controller, leader and readings of one log, for any number of candidate arms."""

    def __init__(
        self,
        log: Prepared,
        table: ParameterTable,
        arm: ArmParameters,
        offsets: Floats | None = None,
        seed: int = SEED,
    ) -> None:
        """`seed` is that of the potentiometers' noise."""
        self.log = log
        self.table = table
        zero = np.zeros(JOINTS) if offsets is None else offsets
        self._made_of = (log, table, arm)
        run = max(log.runs, key=lambda one: one.stop - one.start)
        recorded = log.log
        start, end = float(recorded.time[run.start]), float(recorded.time[run.stop - 1])
        ticks = int((end - start) / TICK_S)
        times: Floats = start + TICK_S * np.arange(ticks, dtype=np.float64)
        leader = at(times, recorded.time, recorded.leader)
        self.follower = at(times + log.delay, recorded.time, recorded.follower)
        self.leader = leader
        reference = np.vstack([np.tile(leader[:1], (LEAD_TICKS, 1)), leader])
        target = np.vstack([np.tile(self.follower[:1], (LEAD_TICKS, 1)), self.follower]) + zero
        self.ticks = ticks
        self.seconds = len(reference) * TICK_S  # simulated for every candidate
        self.time = times
        self.laws = controllers_of(table)
        pots = _pots(log, arm, table, zero)
        self.noise_rad = np.array([pot.noise * pot.track / pots.supply for pot in pots.joint])  # of one conversion
        self._loop = ClosedLoop(
            with_ideal_follower(table),
            known_readings(reference, target),
            pots,
            seed=seed,
            home=_home(self.follower[0] + zero, arm),
            gap=[0.0] * JOINTS,
            weight_s=np.zeros(len(target)),
        )
        self._zero = zero
        self.rows = len(self.follower[::COMPARED_TICKS])

    def with_zero(self, offsets: Floats, seed: int = SEED) -> Loop:
        """Return the experiment with potentiometers that read 0 at other angles, and with other noise."""
        return Loop(*self._made_of, offsets, seed)

    def record(self, plant: Floats) -> tuple[Floats, NDArray[np.int16]]:
        """One candidate's shown angles (rad) and duties at every tick, (ticks, 4) each, in the bench's own steps."""
        rows = np.ascontiguousarray(plant[None])
        result = self._loop.run(self.laws[None], rows, substeps=BENCH_STEPS, every=1)
        shown = shown_angles(result.angles, rows, TICK_S)[0, LEAD_TICKS:] - self._zero
        return shown, result.duties[0, LEAD_TICKS:]

    def angles(self, plants: Floats, every: int = COMPARED_TICKS, threads: int = 0) -> Floats:
        """The angles that the candidates' potentiometers show, (candidates, rows, 4), every `every` ticks."""
        rows = np.ascontiguousarray(plants)
        result = self._loop.run(self.laws[None], rows, substeps=STEPS_PER_TICK, every=every, threads=threads)
        shown = shown_angles(result.angles, rows, every * TICK_S)[:, LEAD_TICKS // every :] - self._zero
        return shown[:, : len(self.follower[::every])]

    def difference(self, plants: Floats, held_out: bool | None = None) -> Floats:
        """Candidates minus log, (candidates, rows, 4), rad: over all of it, the held-out part, or the rest."""
        found = self.angles(plants) - self.follower[None, ::COMPARED_TICKS]
        kept = found if held_out is None else found[:, self.part(held_out)]
        return np.nan_to_num(kept, nan=10.0, posinf=10.0, neginf=-10.0)

    def part(self, held_out: bool) -> NDArray[np.intp]:
        """The rows that are held out, or those that are not."""
        limits = self.log.limits.data
        return part_of(self.rows, round(limits.block_s / (COMPARED_TICKS * TICK_S)), held_out, limits.held_out_every)

    def error(self, plants: Floats, held_out: bool | None = None) -> Floats:
        """Mean squared difference to the log, (candidates, 4), rad²."""
        mse: Floats = np.mean(self.difference(plants, held_out) ** 2, axis=1)
        return mse


class LoopResidual:
    """Model minus log in the closed loop, in rad, for the joints that moved; with or without the held-out part."""

    def __init__(self, loops: Sequence[Loop], joints: Sequence[int], whole: bool = True) -> None:
        self.loops = loops
        self.joints = list(joints)
        self.part = None if whole else False
        rows = [loop.rows if whole else len(loop.part(False)) for loop in loops]
        self.joint_of = np.tile(np.array(self.joints, dtype=np.intp), sum(rows))
        self.seconds = sum(loop.seconds for loop in loops)

    def __call__(self, space: Space, points: Floats) -> Floats:
        plants = space.plants(points)
        rows = [loop.difference(plants, self.part)[..., self.joints].reshape(len(points), -1) for loop in self.loops]
        return np.concatenate(rows, axis=1)


def _home(angles: Floats, arm: ArmParameters) -> list[float]:
    return [
        float(np.clip(angle, joint.stops.min, joint.stops.max)) for angle, joint in zip(angles, arm.joint, strict=True)
    ]


def _pots(log: Prepared, arm: ArmParameters, table: ParameterTable, zero: Floats) -> PotentiometerBank:
    """Usual potentiometers as noisy as the log: the noise lets joints creep that would stick without it."""
    noise = np.minimum(pot_noise(log, table["filter_shift"], arm.follower_pots.supply), DOUBTS.most_noise_v)
    pots = [Potentiometer(centre=float(zero[joint]), noise=float(noise[joint])) for joint in range(JOINTS)]
    return PotentiometerBank(supply=arm.follower_pots.supply, joint=tuple(pots))
