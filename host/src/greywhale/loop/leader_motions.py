"""Leader motions made by the project itself: human-like reaches, the paper's steps and multi-steps, visits of poses.

A human reach is well described by a minimum-jerk path (Flash and Hogan 1985) with a small physiological
tremor at 8 to 12 Hz on top. Pauses between reaches are long enough for a follower to settle, so that a
steady-state error can be read.
"""

from __future__ import annotations

import numpy as np

from greywhale.base.types import Floats
from greywhale.files.trajectory import Trajectory
from greywhale.protocol.firmware import JOINTS

RATE_HZ = 200.0
REACH_S = (0.55, 1.1)
PAUSE_S = (0.8, 1.3)
ONSET_SPREAD_S = 0.08  # joints of one reach do not start in the same instant
TREMOR_HZ = (8.0, 12.0)
TREMOR_RAD = 0.002  # root mean square
# The edge of a step (s), and how many times as fast as on average such a path is in its middle.
EDGE_S = 0.04
MINIMUM_JERK_PEAK = 1.875
# Poses: how far out they are at most, as a share of half the range; how far from a pose each side's approach begins, as
# such a share within these (rad); how long a move to it takes (s), or longer where its peak would be quicker (rad/s).
POSE_SHARE, APPROACH_SHARE, APPROACH_RAD = 0.5, 0.4, (0.08, 0.2)
APPROACH_S, POSES_RAD_S = 0.4, 2.0
TURN_S, VISIT_S = 0.1, 1.0  # a turn before an approach is no rest; a visit lets the follower arrive, and then measures
# The middle, and four corners in which shoulder and wrist lean opposite ways, so that the hand stays about level.
POSES = np.array([[0, 0, 0, 0], [1, 1, -1, 1], [1, -1, 1, -1], [-1, 1, -1, -1], [-1, -1, 1, 1]], dtype=np.float64)
# Comfortable range of each joint, rad: base yaw, shoulder pitch, wrist pitch, wrist roll.
RANGE_RAD = np.array([[-1.0, 1.0], [-0.2, 1.1], [-0.9, 0.7], [-1.2, 1.2]])


def minimum_jerk(progress: Floats) -> Floats:
    """The path from 0 to 1 with the least mean squared jerk; at rest at both ends, held outside [0, 1]."""
    s = np.clip(progress, 0.0, 1.0)
    return s**3 * (10.0 + s * (6.0 * s - 15.0))


def human_reaches(seed: int = 1, duration_s: float = 20.0) -> Trajectory:
    """Reach, pause, reach, ... of about `duration_s`, different for every seed and the same for the same seed."""
    random = np.random.default_rng(seed)
    pose = RANGE_RAD.mean(axis=1)
    starts: list[float] = []
    plans: list[tuple[float, Floats, Floats, Floats]] = []  # length, onset of each joint, pose from, pose to
    now = float(random.uniform(*PAUSE_S))
    while True:
        length = float(random.uniform(*REACH_S))
        pause = float(random.uniform(*PAUSE_S))
        if plans and now + length + ONSET_SPREAD_S + pause > duration_s:
            break
        target = random.uniform(RANGE_RAD[:, 0], RANGE_RAD[:, 1])
        target = np.where(random.random(JOINTS) < 0.25, pose, target)  # a person often leaves a joint where it is
        starts.append(now)
        plans.append((length, random.uniform(0.0, ONSET_SPREAD_S, JOINTS), pose, target))
        pose = target
        now += length + ONSET_SPREAD_S + pause
    time_s = np.arange(round(now * RATE_HZ) + 1) / RATE_HZ
    angles = np.tile(RANGE_RAD.mean(axis=1), (len(time_s), 1))
    for start, (length, onset, origin, target) in zip(starts, plans, strict=True):
        progress = (time_s[:, None] - start - onset[None, :]) / length
        angles += (target - origin)[None, :] * minimum_jerk(progress)
    return Trajectory(time_s, angles + _tremor(random, len(time_s)))


def _tremor(random: np.random.Generator, samples: int) -> Floats:
    """Noise whose spectrum is flat from 8 to 12 Hz and zero elsewhere, independent per joint."""
    frequency = np.fft.rfftfreq(samples, 1.0 / RATE_HZ)
    band = (frequency >= TREMOR_HZ[0]) & (frequency <= TREMOR_HZ[1])
    spectrum = np.zeros((len(frequency), JOINTS), dtype=np.complex128)
    spectrum[band] = random.normal(size=(int(band.sum()), JOINTS)) + 1j * random.normal(size=(int(band.sum()), JOINTS))
    noise = np.fft.irfft(spectrum, n=samples, axis=0)
    rms = np.sqrt(np.mean(noise**2, axis=0))
    return noise * (TREMOR_RAD / np.where(rms > 0.0, rms, 1.0))


def steps(
    amplitude_rad: float = 1.0, before_s: float = 1.0, after_s: float = 4.0, fastest_rad_s: float = np.inf
) -> Trajectory:
    """One step of every joint at the same instant, as in the paper's section 5.3."""
    return multi_steps([0.0, amplitude_rad], [before_s, after_s], fastest_rad_s)


def multi_steps(
    levels_rad: list[float] | None = None, hold_s: list[float] | None = None, fastest_rad_s: float = np.inf
) -> Trajectory:
    """A staircase through `levels_rad`, the same on every joint, each level held for its own time (section 5.4).

    A hand cannot jump: each edge takes 40 ms, which the follower's drive cannot tell from a jump, or as long as it
    takes at `fastest_rad_s`.
    """
    levels = [0.0, 1.0, 0.4, -0.6, -1.0, 0.2, 0.0] if levels_rad is None else levels_rad
    holds = [1.0] + [2.5] * (len(levels) - 1) if hold_s is None else hold_s
    edges = np.cumsum(holds)
    time_s = np.arange(round(float(edges[-1]) * RATE_HZ) + 1) / RATE_HZ
    angle = np.full(len(time_s), levels[0])
    for edge, low, high in zip(edges[:-1], levels[:-1], levels[1:], strict=True):
        takes_s = max(EDGE_S, MINIMUM_JERK_PEAK * abs(high - low) / fastest_rad_s)
        angle += (high - low) * minimum_jerk((time_s - edge) / takes_s)
    return Trajectory(time_s, np.tile(angle[:, None], (1, JOINTS)))


def poses(low: Floats, high: Floats, visits: int) -> Trajectory:
    """Five poses between the angles `low` and `high` (4,) rad, each visited `visits` times from below and from above,
    by all joints at once: a round through all poses after the other, as ISO 9283 has it.
    """
    middle, half = 0.5 * (low + high), 0.5 * (high - low)
    approach = np.minimum(np.clip(APPROACH_SHARE * half, *APPROACH_RAD), half)
    out = np.minimum(POSE_SHARE * half, half - approach)
    each_round = [
        place
        for corner in POSES
        for pose in [middle + out * corner]
        for place in (pose - approach, pose, pose + approach, pose)
    ]
    holds = [TURN_S, VISIT_S] * (len(each_round) // 2 * visits)
    return move_through(each_round * visits, holds, APPROACH_S, POSES_RAD_S)


def move_through(stops: list[Floats], holds: list[float], edge_s: float, fastest_rad_s: float) -> Trajectory:
    """From stop to stop, each held for its time; an edge takes `edge_s`, or longer where it would be too quick."""
    times, rows = [np.zeros(1)], [np.array([stops[0]])]
    now = holds[0]
    for before, after, hold in zip(stops[:-1], stops[1:], holds[1:], strict=True):
        edge = max(edge_s, MINIMUM_JERK_PEAK * float(np.abs(after - before).max()) / fastest_rad_s)
        grid = np.arange(1, round(edge * RATE_HZ) + 1) / RATE_HZ
        share = minimum_jerk(grid / grid[-1])[:, None]
        times += [np.array([now]), now + grid]
        rows += [before[None], before + share * (after - before)]
        now += grid[-1] + hold
    times.append(np.array([now]))
    rows.append(stops[-1][None])
    return Trajectory(np.concatenate(times), np.vstack(rows))
