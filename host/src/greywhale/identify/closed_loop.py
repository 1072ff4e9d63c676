"""The second residual: candidate arms inside the controller that made the log, led by the logged leader.

It cannot be fooled by where a window starts, and it is what a model is for: the response of the closed loop.
"""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
from numpy.typing import NDArray

from greywhale import _native
from greywhale.arm import ArmParameters
from greywhale.identify.data import BLOCK_S, Prepared, part_of
from greywhale.identify.noise import TRACK, pot_noise
from greywhale.identify.space import JOINTS, Space
from greywhale.loop import CONTROLLER_COLUMNS, Timing
from greywhale.protocol import schema

Floats = NDArray[np.float64]
TICK_S = 1e-3
LSB = 1.0 / 4096.0
# The loop stands still at the first pose for so long before the log begins (ticks), so that it is not let go from rest.
LEAD_TICKS = 500
PWM_TOP = {"mega2560": 400, "nano328": 400}
COMPARED_TICKS = 5
STEPS_PER_TICK = 2
ROWS_PER_BLOCK = round(BLOCK_S / (COMPARED_TICKS * TICK_S))
SEED = 1


class Loop:
    """The controller, leader and readings of one log, for any number of candidate arms."""

    def __init__(self, log: Prepared, values: Sequence[int], arm: ArmParameters, offsets: Floats | None = None) -> None:
        self.log = log
        zero = np.zeros(JOINTS) if offsets is None else offsets
        self._made_of = (log, values, arm)
        run = max(log.runs, key=lambda one: one.stop - one.start)
        recorded = log.log
        start, end = float(recorded.time[run.start]), float(recorded.time[run.stop - 1])
        ticks = int((end - start) / TICK_S)
        times: Floats = start + TICK_S * np.arange(ticks, dtype=np.float64)
        leader = _at(times, recorded.time, recorded.leader)
        self.follower = _at(times + log.delay, recorded.time, recorded.follower)
        reference = np.vstack([np.tile(leader[:1], (LEAD_TICKS, 1)), leader])
        target = np.vstack([np.tile(self.follower[:1], (LEAD_TICKS, 1)), self.follower]) + zero
        self.ticks = ticks
        self.seconds = len(reference) * TICK_S  # simulated for every candidate
        self.time = times
        self.laws = controller_rows(values)
        settings = loop_settings(values)
        moments = Timing().native()
        noisy = _pots(log, arm, values, zero)
        self._loop = _native.ClosedLoop(
            settings=settings,
            timing=moments,
            pots=noisy,
            pot_supply=arm.follower_pots.supply,
            seed=SEED,
            home=_home(self.follower[0] + zero, arm),
            gap=[0.0] * JOINTS,
            reference=np.ascontiguousarray(np.clip(np.round(reference / LSB), -32768, 32767).astype(np.int16)),
            leader=np.ascontiguousarray(target),
            weight=np.zeros(len(target)),
        )
        self._zero = zero
        self.rows = len(self.follower[::COMPARED_TICKS])

    def with_zero(self, offsets: Floats) -> Loop:
        """The same experiment with potentiometers that read 0 at other angles."""
        return Loop(*self._made_of, offsets)

    def angles(self, plants: Floats, every: int = COMPARED_TICKS, threads: int = 0) -> Floats:
        """What the candidates' potentiometers show, (candidates, rows, 4), every so many ticks of the log."""
        outcome = self._run(plants, every, threads)
        shown: Floats = outcome[4][:, LEAD_TICKS // every :].astype(np.float64) - self._zero
        return shown[:, : len(self.follower[::every])]

    def error(self, plants: Floats, held_out: bool | None = None) -> Floats:
        """Mean squared difference to the log, (candidates, 4), rad²: all of it, what is held out, or the rest."""
        difference = self.angles(plants) - self.follower[None, ::COMPARED_TICKS]
        kept = difference if held_out is None else difference[:, part_of(self.rows, ROWS_PER_BLOCK, held_out)]
        mse: Floats = np.mean(np.nan_to_num(kept, nan=10.0, posinf=10.0, neginf=-10.0) ** 2, axis=1)
        return mse

    def _run(self, plants: Floats, every: int, threads: int) -> tuple[Floats, ...]:
        outcome: tuple[Floats, ...] = self._loop.run(
            controllers=self.laws[None],
            plants=np.ascontiguousarray(plants),
            substeps=STEPS_PER_TICK,
            threads=threads,
            every=every,
            single=False,
            instructions="",
        )
        return outcome


class LoopResidual:
    """Model minus log in the closed loop, in rad, for the joints that moved; with or without what is held out."""

    def __init__(self, loops: Sequence[Loop], joints: Sequence[int], whole: bool = True) -> None:
        self.loops = loops
        self.joints = list(joints)
        self.whole = whole
        rows = [loop.rows if whole else len(part_of(loop.rows, ROWS_PER_BLOCK, False)) for loop in loops]
        self.joint_of = np.tile(np.array(self.joints, dtype=np.intp), sum(rows))
        self.seconds = sum(loop.seconds for loop in loops)

    def __call__(self, space: Space, points: Floats) -> Floats:
        plants = space.plants(points)
        rows = []
        for loop in self.loops:
            difference = loop.angles(plants) - loop.follower[None, ::COMPARED_TICKS]
            if not self.whole:
                difference = difference[:, part_of(loop.rows, ROWS_PER_BLOCK, False)]
            kept = difference[..., self.joints]
            rows.append(np.nan_to_num(kept, nan=10.0, posinf=10.0, neginf=-10.0).reshape(len(points), -1))
        return np.concatenate(rows, axis=1)


def controller_rows(values: Sequence[int]) -> NDArray[np.int32]:
    """The controllers of a whole parameter table."""
    rows = [[_value(values, f"joint{joint}.{key}") for key in CONTROLLER_COLUMNS] for joint in range(JOINTS)]
    return np.array(rows, dtype=np.int32)


def loop_settings(values: Sequence[int]) -> _native.LoopSettings:
    """What the firmware does around the law; the log begins after the soft start."""

    def four(group: str, key: str) -> list[int]:
        return [_value(values, f"{group}{joint}.{key}") for joint in range(JOINTS)]

    return _native.LoopSettings(
        period_ms=_value(values, "period_ms"),
        supply_mv=_value(values, "supply_mv"),
        soft_start_ms=0,
        filter_shift=_value(values, "filter_shift"),
        limit_min=four("joint", "limit_min"),
        limit_max=four("joint", "limit_max"),
        motor_sign=[1] * JOINTS,
        pwm_top=[400] * JOINTS,
        leader_zero=four("leader", "zero"),
        leader_scale=four("leader", "scale"),
        follower_zero=[8184] * JOINTS,
        follower_scale=[10734] * JOINTS,
    )


def _value(values: Sequence[int], name: str) -> int:
    return values[schema.PARAMETER_BY_NAME[name].index]


def _at(times: Floats, known: Floats, angles: Floats) -> Floats:
    return np.column_stack([np.interp(times, known, angles[:, joint]) for joint in range(JOINTS)])


def _home(angles: Floats, arm: ArmParameters) -> list[float]:
    return [
        float(np.clip(angle, joint.stops.min, joint.stops.max)) for angle, joint in zip(angles, arm.joint, strict=True)
    ]


def _pots(log: Prepared, arm: ArmParameters, values: Sequence[int], zero: Floats) -> list[_native.Potentiometer]:
    """Ideal 300 degree potentiometers as noisy as the log: the noise lets joints creep that would stick without it."""
    noise = pot_noise(log, _value(values, "filter_shift"), arm.follower_pots.supply)
    return [
        _native.Potentiometer(
            track=TRACK, centre=float(zero[joint]), direction=1.0, noise=float(noise[joint]), linearity=0.0
        )
        for joint in range(JOINTS)
    ]
