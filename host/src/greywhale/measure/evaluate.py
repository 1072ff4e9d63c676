"""The paper's three measures of a log (section 5.1), made exact, and how the follower settles.

- Input tracking: mean of (leader - follower)^2 over the measured samples; the total is the sum over the joints, as in
  equation 5 and table 11.
- Steady-state error: "the difference between the desired final position and the actual position in steady state".
  Here the mean of |leader - follower| over the last REST_S of each rest, and no sooner than REST_S after the leader
  came to rest, which is when it has stayed within REST_RAD for so long. The rest with which a log begins
  follows no move, so it counts only where there is no other. None where the leader never rests.
- Settling error: the same mean over all samples from REST_S after the leader came to rest. A slow follower is then
  still on its way; so it tells how soon and how well the follower gets there, and the steady-state error where it ends.
- Time delay: two definitions, see `delay.py`. `delay_s` is the lag at which the follower resembles the leader most,
  defined for any motion; `onset_delay_s` is the paper's, "the difference between the times that the leader gives a
  position command and the follower begins to respond", and exists only where the leader steps out of a rest.
- Overshoot and settling time of such steps: see `step_response.py`. Of several steps, the worst counts.
- Ripple of the voltage: see `swings.py`. It needs a sample each tick.

Measured samples are those in state `following`; a log without any (motors off) is measured whole, and says so.
Samples that the link dropped are absent, not filled in: the means run over what was received. Steady state and delays
look only at runs of samples without a gap.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Literal, TypedDict

import numpy as np
from numpy.typing import NDArray
from threadpoolctl import threadpool_limits

from greywhale.base.errors import UserError
from greywhale.base.types import Floats, PerJoint
from greywhale.files.log import Log
from greywhale.files.log.driven import as_slice, following_rows
from greywhale.measure.delay import correlation_delay, onset_delay
from greywhale.measure.following import follows
from greywhale.measure.limits import STEPS
from greywhale.measure.runs import REST_RAD, REST_S, Run, first_part, gap_free_runs, last_part, resting
from greywhale.measure.step_response import StepResponse, answer, departures, worst
from greywhale.measure.swings import RIPPLE_S, ripple_of_record
from greywhale.protocol.firmware import JOINTS, TICK_S
from greywhale.protocol.joints import ALL, Joints


class JointFacts(TypedDict):
    in_use: bool  # whether the arm has this joint
    mse_rad2: float
    steady_state_error_rad: float | None  # mean absolute error at the end of rests; null where there is none
    settling_error_rad: float | None  # mean absolute error from 0.5 s after the leader came to rest
    time_delay_s: float | None  # lag at which the follower resembles the leader most; null where nothing moves
    onset_delay_s: float | None  # between the onsets of steps; null without steps out of a rest
    overshoot_percent: float | None  # beyond the leader's new place, % of the step, the largest; null without steps
    settling_s: float | None  # until the follower stays within 5 % of the step (0.02 rad), the longest; null: never
    steps: int  # out of a rest
    unsettled_steps: int  # after which the follower never settles
    follows: bool  # whether the joint follows its leader at all
    ripple_v: float | None  # rms of the voltage above some 20 Hz; null without a sample each ms
    leader_rested_s: float


class EvaluationFacts(TypedDict):
    joints: PerJoint[JointFacts]
    total_mse_rad2: float  # sum over the joints
    samples: int  # that were measured
    duration_s: float  # that was measured: without gaps
    span_s: float  # from the log's first row to its last
    measured: Literal["following", "whole log, motors never followed"]  # which part of the log


@dataclass(frozen=True)
class JointMeasures:
    """rad^2, rad, s, s; None where the motion does not define the measure.

    `follows` is False where the follower does not follow at all: see `following.py`. Overshoot and settling time are
    the largest of all steps; the latter is None also where one of them, counted in `unsettled_steps`, never settled.
    """

    mse: float
    steady_state_error: float | None
    delay_s: float | None
    onset_delay_s: float | None
    steps: int
    follows: bool = True
    overshoot_percent: float | None = None
    settling_s: float | None = None
    unsettled_steps: int = 0
    ripple_v: float | None = None
    settling_error: float | None = None

    def settling(self, form: str) -> str | None:
        """The settling time as a person reads it; "never" where a step did not settle, None without steps."""
        if self.unsettled_steps:
            return "never"
        return None if self.settling_s is None else f"{self.settling_s:{form}}"


@dataclass(frozen=True)
class Evaluation:
    """The measures of one log; `rests_s` tells per joint how long the leader rested.

    They cover `duration_s` of the `span_s` between its first row and its last: no gaps, and only where motors followed.
    """

    joints: tuple[JointMeasures, ...]
    total_mse: float
    samples: int
    duration_s: float
    following: bool
    rests_s: tuple[float, ...]
    joints_in_use: Joints = ALL  # the others have measures too, of a motion that is 0
    span_s: float | None = None  # None: all of it was measured

    def as_dict(self) -> EvaluationFacts:
        return {
            "joints": [
                {
                    "in_use": number in self.joints_in_use,
                    "mse_rad2": joint.mse,
                    "steady_state_error_rad": joint.steady_state_error,
                    "settling_error_rad": joint.settling_error,
                    "time_delay_s": joint.delay_s,
                    "onset_delay_s": joint.onset_delay_s,
                    "overshoot_percent": joint.overshoot_percent,
                    "settling_s": joint.settling_s,
                    "steps": joint.steps,
                    "unsettled_steps": joint.unsettled_steps,
                    "follows": joint.follows,
                    "ripple_v": joint.ripple_v,
                    "leader_rested_s": rested,
                }
                for number, (joint, rested) in enumerate(zip(self.joints, self.rests_s, strict=True))
            ],
            "total_mse_rad2": self.total_mse,
            "samples": self.samples,
            "duration_s": self.duration_s,
            "span_s": self.duration_s if self.span_s is None else self.span_s,
            "measured": "following" if self.following else "whole log, motors never followed",
        }


def evaluate(log: Log) -> Evaluation:
    """Measure every joint of a log."""
    measured = following_rows(log)
    runs = gap_free_runs(log.time, measured)
    if not runs:
        raise UserError(
            f"{log.name}: nothing to measure: no two neighbouring samples in state following; record longer."
        )
    joints, rests = [], []
    # Each of the thousands of correlations is too short for BLAS threads, which would wait for a busy core.
    with threadpool_limits(limits=1, user_api="blas"):
        for joint in range(JOINTS):
            measures, rested = _joint(log, joint, measured, runs)
            joints.append(measures)
            rests.append(rested)
    return Evaluation(
        joints=tuple(joints),
        total_mse=sum(joints[number].mse for number in log.joints_in_use),
        samples=int(measured.sum()),
        duration_s=sum(run.period * (run.stop - run.start - 1) for run in runs),
        following=bool(log.following.any()),
        rests_s=tuple(rests),
        joints_in_use=log.joints_in_use,
        span_s=float(log.time[-1] - log.time[0]),
    )


def _ripple(log: Log, joint: int, run: Run) -> float | None:
    if abs(run.period - TICK_S) > 0.1 * TICK_S or run.stop - run.start < 2 * RIPPLE_S / TICK_S:
        return None
    return float(ripple_of_record(log.held("voltage")[run.slice, [joint]])[0])


def _mean_square(error: Floats) -> float:
    """The mean square; the errors are lost."""
    return float(np.mean(np.square(error, out=error)))


def _mean_error(error: Floats) -> float | None:
    return float(np.mean(np.abs(error))) if error.size else None


def _joint(log: Log, joint: int, measured: NDArray[np.bool_], runs: list[Run]) -> tuple[JointMeasures, float]:
    longest = max(runs, key=lambda run: run.stop - run.start)
    ripple = _ripple(log, joint, longest)  # before there are angles: a log of an hour is large
    leader, follower = (log.held(name)[:, joint] for name in ("leader", "follower"))
    at_rest, at_end, at_begin = np.zeros((3, len(leader)), dtype=bool)
    onsets: list[float] = []
    answers: list[StepResponse] = []
    for run in runs:
        led, followed, window = leader[run.slice], follower[run.slice], run.samples(REST_S)
        rest = resting(led, window, REST_RAD)
        at_rest[run.slice] = rest
        at_end[run.slice] = last_part(rest, window)
        if run is runs[0]:
            at_begin[run.slice] = first_part(rest, window)
        for step in departures(led, rest, run.period):
            onset = onset_delay(led, followed, step, window)
            onsets += [] if onset is None else [onset * run.period]
            found = answer(led, followed, rest, step, run.period)
            answers += [] if found is None else [found]
    overshoot, settling = worst(answers)
    final = at_end & ~at_begin
    settled = final if final.any() else at_end
    part = as_slice(measured)  # one copy is gone before the next: a log of an hour is large
    measures = JointMeasures(
        mse=_mean_square(leader[part] - follower[part]),
        steady_state_error=_mean_error(leader[settled] - follower[settled]),
        delay_s=correlation_delay(leader[longest.slice], follower[longest.slice], longest.period),
        onset_delay_s=float(np.mean(onsets)) if onsets else None,
        steps=len(onsets),
        follows=follows(leader[part], follower[part], longest.period),
        overshoot_percent=overshoot,
        settling_s=settling,
        unsettled_steps=sum(one.settling_s is None for one in answers),
        ripple_v=ripple,
        settling_error=_mean_error(leader[at_rest] - follower[at_rest]),
    )
    return measures, float(np.count_nonzero(at_rest) * longest.period)


def more_overshoot(before: Evaluation, after: Evaluation) -> str:
    """The joints in use that overshoot clearly more than before, such as "joint 2 from 4 to 31 %"; "" for none."""
    said = []
    for joint in before.joints_in_use:
        was, now = before.joints[joint].overshoot_percent, after.joints[joint].overshoot_percent
        if was is not None and now is not None and now > was + STEPS.more_percent:
            said.append(f"joint {joint} from {was:.0f} to {now:.0f} %")
    return ", ".join(said)
