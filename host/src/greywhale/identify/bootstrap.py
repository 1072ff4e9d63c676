"""The uncertainty of a model from logs that it makes itself: a parametric bootstrap (Efron and Tibshirani 1993, ch. 6).

The identified arm is led by the leaders of the logs, under their controllers, with fresh noise and through the same
converter. Each of these logs is fitted as the real one was. What the fits are off, bias included, is what the real fit
may be off; no formula covers converter steps, starts within a gap, or a fit that stops on a ridge.

A few logs show the spread of many numbers badly. So their scatter is drawn towards the shape that the formula of
`uncertainty` gives, made as large as the scatter is on average in each group of joints that feel each other.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from concurrent.futures import ThreadPoolExecutor
from dataclasses import replace

import numpy as np
from threadpoolctl import threadpool_limits

from greywhale.arm.parameters import USUAL_TRACK_RAD
from greywhale.base.types import Floats
from greywhale.identify.closed_loop import Loop
from greywhale.identify.data import Prepared, prepare
from greywhale.identify.knocking import turns_of
from greywhale.identify.limits import IDENTIFICATION_LIMITS, UncertaintyLimits
from greywhale.identify.space import COUPLED, WHOLE_ARM, Space
from greywhale.identify.steps import ROUGHLY_ENOUGH, WindowFit
from greywhale.identify.windows import WindowResidual
from greywhale.loop.leader import SLICE_S
from greywhale.protocol.firmware import ANGLE_LSB, CONVERTER_COUNTS, TICK_S, pwm_steps

LOGS = 6  # simulated; more would only take longer
STEPS = 8  # of a fit; more would only take longer
# Moments of a tick at which its four conversions hold their input, as shares of it.
MOMENTS = (0.1, 0.3, 0.5, 0.7)


def scatter_of_fits(
    logs: Sequence[Prepared],
    loops: Sequence[Loop],
    space: Space,
    x: Floats,
    covariance: Floats,
    joints: Sequence[int],
    knocking: Sequence[int],
    seed: int,
    report: Callable[[float], None],
) -> Floats:
    """Return how far fits to simulated logs are off the point `x` behind them: (fits, numbers). Ctrl-C ends it early.

    Each fit starts elsewhere, by the formula's `covariance`: the real one did not start at the truth either.
    """
    root = np.linalg.cholesky(covariance)
    low, high = space.bounds()
    plant, zero = space.plants(x[None])[0], space.offsets(x[None])[0]

    def fit(number: int) -> Floats:
        made = [_simulate(*pair, plant, zero, 1 + number + LOGS * seed) for pair in zip(logs, loops, strict=True)]
        windows = WindowResidual(made, space.arm, joints, longest_step=SLICE_S)
        start = x + logs[0].limits.uncertainty.start_sigmas * root @ np.random.default_rng(
            [seed, number]
        ).standard_normal(len(x))
        fitted = np.clip(start, low, high)
        for seen, free in turns_of(windows, space, knocking):
            seen.settle(plant, zero)
            fitted = WindowFit(seen, space, fitted, free, ROUGHLY_ENOUGH).run(STEPS)
        return fitted - x

    found: list[Floats] = []
    # Two at a time: one works in numpy while the other simulates.
    with threadpool_limits(limits=1, user_api="blas"), ThreadPoolExecutor(2) as pool:
        fits = [pool.submit(fit, number) for number in range(LOGS)]
        try:
            for number, one in enumerate(fits):
                report(number / LOGS)
                found.append(one.result())
        except KeyboardInterrupt:
            for one in fits:
                one.cancel()
    return np.array(found).reshape(-1, len(x))


def spread_covariance(
    covariance: Floats,
    scatter: Floats,
    space: Space,
    x: Floats,
    limits: UncertaintyLimits = IDENTIFICATION_LIMITS.uncertainty,
) -> Floats:
    """The covariance of the formula at `x`, made to cover the scatter of fits (fits, numbers), group by group."""
    if not len(scatter):
        return covariance
    scale = np.ones(len(space))
    for joints in (*COUPLED, (WHOLE_ARM,)):
        mine = [index for index, one in enumerate(space.parameters) if one.joint in joints]
        if mine:
            inside = np.linalg.solve(covariance[np.ix_(mine, mine)], scatter[:, mine].T)
            scale[mine] = np.sqrt(max(1.0, float(np.mean(np.sum(scatter[:, mine].T * inside, axis=0))) / len(mine)))
    shape = covariance * np.outer(scale, scale)
    count = limits.shape_logs + len(scatter)
    # From so few logs the variance itself is uncertain: it is that of Student's t.
    student = count / (count - 2.0)
    spread = limits.widened * student * (limits.shape_logs * shape + scatter.T @ scatter) / count
    spread += np.diag(_systematic(space, limits) ** 2)
    # No number is less certain than in the user's arm file.
    known: Floats = np.linalg.inv(np.linalg.inv(spread) + np.diag(space.doubts_at(x) ** -2.0))
    return (known + known.T) / 2.0


def _systematic(space: Space, limits: UncertaintyLimits) -> Floats:
    """Return how far fits are off beyond their scatter (docs/identify.md)."""
    kinds, alphas = dict(limits.systematic), limits.systematic_alpha
    known = [alphas[one.joint] if one.kind == "alpha" else kinds.get(one.kind, 0.0) for one in space.parameters]
    return np.array(known)


def _simulate(log: Prepared, loop: Loop, plant: Floats, zero: Floats, seed: int) -> Prepared:
    """The log that the plant would have made, read by another draw of noise."""
    own = loop.with_zero(zero, seed)
    shown, duties = own.record(plant)
    shift = own.table["filter_shift"]
    readings = read_motion(shown, own.noise_rad, shift, np.random.default_rng(seed))
    run = max(log.runs, key=lambda one: one.stop - one.start)
    rows = np.clip(np.round((log.log.time[run.slice] - log.log.time[run.start]) / TICK_S).astype(int), 0, own.ticks - 1)
    supply = own.table["supply_mv"] / 1000.0
    recorded = replace(
        log.log,
        time=log.log.time[run.slice],
        leader=log.log.leader[run.slice],
        follower=readings[rows],
        voltage=duties[rows] / np.array(pwm_steps(own.table.board)) * supply,
        state=log.log.state[run.slice],
    )
    return prepare(recorded, shift, log.limits)


def read_motion(shown: Floats, noise: Floats, shift: int, random: np.random.Generator) -> Floats:
    """Read what potentiometers show at every tick, (ticks, 4) rad, as the firmware does: four conversions, a filter."""
    from scipy.signal import lfilter  # slow to import

    before = np.vstack([shown[:1], shown[:-1]])
    step = USUAL_TRACK_RAD / CONVERTER_COUNTS
    mean = np.zeros_like(shown)
    for moment in MOMENTS:
        seen = before + moment * (shown - before) + noise * random.standard_normal(shown.shape)
        mean += (np.floor(seen / step) + 0.5) * step / len(MOMENTS)
    share = 1.0 / (1 << shift)
    filtered, _ = lfilter([share], [1.0, share - 1.0], mean, axis=0, zi=(1.0 - share) * mean[:1])
    readings: Floats = np.round(filtered / ANGLE_LSB) * ANGLE_LSB
    return readings
