"""Compares white box and model on every log.

They run in the closed loop with the log's own controller, because a model is for that. Where the controller is unknown,
they run over windows under the logged voltages.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass
from typing import Annotated, NotRequired, TypedDict

import numpy as np
from numpy.typing import NDArray

from greywhale.arm import ArmParameters
from greywhale.arm.parameters import JOINT_NAMES
from greywhale.base.types import Floats, PerJoint
from greywhale.identify.closed_loop import COMPARED_TICKS, Loop
from greywhale.identify.data import Prepared
from greywhale.identify.limits import IDENTIFICATION_LIMITS, JudgeLimits
from greywhale.identify.space import Space
from greywhale.identify.windows import WindowResidual
from greywhale.measure.swings import smooth_motion
from greywhale.measure.swings_in_logs import FIT_IT, Swings, describe_difference, swings_of
from greywhale.protocol.firmware import CONVERTER_COUNTS, JOINTS, TICK_S
from greywhale.protocol.table import ParameterTable

TINY = 1e-12  # rad², beside every error of a joint that moved
CLOSED_LOOP, WINDOWS = "closed loop", "logged voltages, windows"
FIT, SECOND, CHANGED = "fit", "validation", "validation, changed controller"


class FollowingFacts(TypedDict):
    following_improvement: NotRequired[float]  # without the swings of joints that hunt
    unexplained: NotRequired[PerJoint[float]]  # share of the tracking error that the model leaves
    hunts: NotRequired[PerJoint[bool]]  # in the log
    model_hunts: NotRequired[PerJoint[bool]]
    swings_rad: NotRequired[PerJoint[float]]  # rms, in the log
    model_swings_rad: NotRequired[PerJoint[float]]
    swings_hz: NotRequired[PerJoint[float]]  # in the log
    model_swings_hz: NotRequired[PerJoint[float]]


class VerdictFacts(FollowingFacts):
    measure: Annotated[str, ("enum", [CLOSED_LOOP, WINDOWS])]  # how model and log were compared
    white_box_mse_rad2: PerJoint[float]  # your arm's error; 0 for joints that were not identified
    model_mse_rad2: PerJoint[float]
    model_rms_mrad: PerJoint[float]  # the same error as an angle
    improvement: float  # 1 is perfect, 0 no better than your arm
    chance_rad2: float  # by how much the model may be further from the log than your arm without being worse


@dataclass(frozen=True)
class JudgedLog:
    """A log on which arms are judged."""

    log: Prepared
    table: ParameterTable | None
    role: str


@dataclass(frozen=True)
class Following:
    """The closed loop without the swings of joints that hunt, and these by themselves; (4,) each.

    `model` and `white_box` are mean squared differences to the log, rad². `error` is the log's own tracking error.
    """

    white_box: tuple[float, ...]
    model: tuple[float, ...]
    error: tuple[float, ...]
    log_swings: Swings
    model_swings: Swings

    @property
    def improvement(self) -> float:
        """As in LogVerdict."""
        before = sum(self.white_box)
        return 1.0 - sum(self.model) / before if before > 0.0 else 0.0

    @property
    def unexplained(self) -> tuple[float, ...]:
        """Each joint's tracking error that the model leaves unexplained, as a share of that error."""
        return tuple(left / max(whole, TINY) for left, whole in zip(self.model, self.error, strict=True))

    def as_dict(self) -> FollowingFacts:
        return {
            "following_improvement": self.improvement,
            "unexplained": list(self.unexplained),
            "hunts": list(self.log_swings.hunts),
            "model_hunts": list(self.model_swings.hunts),
            "swings_rad": list(self.log_swings.rms),
            "model_swings_rad": list(self.model_swings.rms),
            "swings_hz": list(self.log_swings.frequency),
            "model_swings_hz": list(self.model_swings.frequency),
        }


@dataclass(frozen=True)
class LogVerdict:
    """Mean squared differences between log and model, rad², per joint.

    `chance` (rad², of all joints together) is what a model that was fitted to a log of the white box itself may be
    further from another log than the white box: noise has moved its numbers, and readings come in steps.
    """

    name: str
    role: str
    measure: str
    white_box: tuple[float, ...]
    model: tuple[float, ...]
    following: Following | None = None
    chance: float = 0.0
    limits: JudgeLimits = IDENTIFICATION_LIMITS.judge

    @property
    def improvement(self) -> float:
        """1 is perfect, 0 no better than the white box."""
        before = sum(self.white_box)
        return 1.0 - sum(self.model) / before if before > 0.0 else 0.0

    @property
    def rms_mrad(self) -> tuple[float, ...]:
        """By how much the model's angles are off, mrad rms, per joint."""
        return tuple(1e3 * math.sqrt(one) for one in self.model)

    @property
    def is_worse(self) -> bool:
        """True where the model is further from the log than the white box is, by more than chance excuses."""
        return self.excess > self._excused

    @property
    def is_as_good(self) -> bool:
        """True where chance explains which of both is nearer to the log, of a model that is certain enough."""
        return abs(self.excess) <= self._excused and not self.is_undecided

    @property
    def is_undecided(self) -> bool:
        """True where the model is so uncertain that the log decides nothing: the fit allows models that are further off
        than it, by more than the whole error of the white box.
        """
        return self.chance > self._most_excused

    @property
    def comparison(self) -> str:
        """The model beside the white box, in words such as "3.1 % better" or "24 times worse"."""
        before, after = sum(self.white_box), sum(self.model)
        if before > 0.0 and 2.0 * before <= after:
            return f"{after / before:.3g} times worse"
        return f"{100 * abs(self.improvement):.1f} % {'worse' if self.improvement < 0.0 else 'better'}"

    @property
    def _most_excused(self) -> float:
        """Of a model that is less certain nothing is known: an error up to this, or the white box's own."""
        return max(sum(self.white_box), JOINTS * self.limits.small_rad**2)

    @property
    def _excused(self) -> float:
        return min(self.chance, self._most_excused)

    @property
    def excess(self) -> float:
        """By how much the model is further from the log than the white box is, all joints together, rad²."""
        return sum(self.model) - sum(self.white_box)

    def as_dict(self) -> VerdictFacts:
        following: FollowingFacts = {} if self.following is None else self.following.as_dict()
        return {
            "measure": self.measure,
            "white_box_mse_rad2": list(self.white_box),
            "model_mse_rad2": list(self.model),
            "model_rms_mrad": list(self.rms_mrad),
            "improvement": self.improvement,
            "chance_rad2": self.chance,
            **following,
        }


def judge(
    subject: JudgedLog,
    arm: ArmParameters,
    plant: Floats,
    zero: Floats,
    joints: Sequence[int],
    draws: Floats | None = None,
) -> LogVerdict:
    """Judge both arms on one log; joints that were not identified do not count.

    `draws` (n, columns) are plants that the fit allows as well; without them only a converter's steps are chance.
    """
    draws = np.zeros((0, len(plant))) if draws is None else draws
    white = Space.of(arm, (), ())
    kept = np.isin(np.arange(JOINTS), list(joints))
    following = None
    if subject.table is not None:
        loop = Loop(subject.log, subject.table, arm)
        own = loop.with_zero(zero) if zero.any() else loop
        shown = [one.angles(row[None])[0] for one, row in ((loop, white.base), (own, plant))]
        log = loop.follower[::COMPARED_TICKS]
        before, after = (_squares(angles, log) for angles in shown)
        others = [_squares(angles, log) for angles in (own.angles(draws) if len(draws) else ())]
        following = _following(loop, shown[0], shown[1], kept)
        measure = CLOSED_LOOP
    else:
        windows = WindowResidual([subject.log], arm, range(JOINTS))
        before = windows.mse(white.base, np.zeros(JOINTS))
        after = windows.mse(plant, zero)
        others = [windows.mse(draw, zero) for draw in draws]
        measure = WINDOWS
    one, other = (tuple(float(value) for value in np.where(kept, errors, 0.0)) for errors in (before, after))
    limits = subject.log.limits.judge
    apart = np.array([errors[kept].sum() for errors in others])
    chance = _worse_by_chance(float(after[kept].sum()), apart, limits.sure_share)
    chance += float(_unresolved(arm)[kept].sum())
    return LogVerdict(subject.log.log.name, subject.role, measure, one, other, following, chance, limits)


def _worse_by_chance(estimate: float, draws: Floats, sure_share: float) -> float:
    """By how much a plant that the fit allows is further from the log than the estimate, in all but few cases."""
    return max(0.0, float(np.quantile(draws, sure_share)) - estimate) if len(draws) else 0.0


def _unresolved(arm: ArmParameters) -> Floats:
    """Return the error that a converter's steps hide, rad² (4,): even the true arm is off its own log by so much."""
    steps = np.array([pot.track for pot in arm.follower_pots.joint]) / CONVERTER_COUNTS
    return steps**2 / 12.0


def _squares(one: Floats, other: Floats) -> Floats:
    """Mean squared difference (4,) of two records, rad²; a motion that left the range of numbers is far off."""
    found: Floats = np.mean(np.nan_to_num(one - other, nan=10.0, posinf=10.0, neginf=-10.0) ** 2, axis=0)
    return found


def _following(loop: Loop, white: Floats, model: Floats, kept: NDArray[np.bool_]) -> Following:
    row_s = COMPARED_TICKS * TICK_S
    log, leader = loop.follower[::COMPARED_TICKS], loop.leader[::COMPARED_TICKS]
    smooth = smooth_motion(log, row_s)
    squares = [_squares(smooth_motion(other, row_s), smooth) for other in (white, model, leader)]
    parts = [tuple(float(value) for value in np.where(kept, one, 0.0)) for one in squares]
    return Following(parts[0], parts[1], parts[2], swings_of(log, leader, row_s), swings_of(model, leader, row_s))


def warnings_of(verdicts: Sequence[LogVerdict]) -> list[str]:
    """Sentences for numbers that speak against the model."""
    sentences = []
    for verdict in verdicts:
        if verdict.is_worse:
            sentences.append(
                f"{verdict.name} ({verdict.role}): the model is worse than the arm file that it began with, by more "
                f"than chance excuses ({sum(verdict.model):.3g} against {sum(verdict.white_box):.3g} rad²)."
            )
    usual = [verdict for verdict in verdicts if verdict.role != CHANGED]
    changed = [verdict for verdict in verdicts if verdict.role == CHANGED]
    if len(usual) > 1 and not any(one.is_worse for one in usual) and any(one.is_worse for one in changed):
        sentences.append(
            "The model does well on the logs of its own controller but not with a changed one: it has learnt that "
            "controller, not the arm. Do not tune with it; check supply, controller file and directions, record again."
        )
    return sentences


def undecided_of(verdicts: Sequence[LogVerdict]) -> list[str]:
    """Sentences for logs on which the model is too uncertain to be better or worse."""
    return [
        f"{verdict.name} ({verdict.role}): these logs decide nothing: models that fit them as well differ here by "
        f"{verdict.chance:.3g} rad², more than the whole error of the arm file ({sum(verdict.white_box):.3g} rad²); "
        "record livelier motion of all joints."
        for verdict in verdicts
        if verdict.is_undecided
    ]


def doubts_of(verdicts: Sequence[LogVerdict], joints: Sequence[int]) -> tuple[str, ...]:
    """Sentences about joints that the model does not understand: hunting, or a changed controller predicted badly."""
    sentences = []
    own = [one.following for one in verdicts if one.role != CHANGED and one.following is not None]
    for verdict in verdicts:
        if verdict.following is None:
            continue
        sentences += describe_difference(
            verdict.name,
            verdict.following.log_swings,
            verdict.following.model_swings,
            tuple(joints),
            fitted=verdict.role == FIT,
        )
        if verdict.role == CHANGED and own:
            sentences += _describe_unexplained(verdict, own, joints)
    return tuple(sentences)


def _describe_unexplained(verdict: LogVerdict, own: Sequence[Following], joints: Sequence[int]) -> list[str]:
    assert verdict.following is not None
    sentences, limits = [], verdict.limits
    for joint in joints:
        share, usual = verdict.following.unexplained[joint], max(one.unexplained[joint] for one in own)
        left = np.sqrt(verdict.following.model[joint])
        if share > limits.max_unexplained and share > limits.worse_times * usual and left > limits.small_rad:
            sentences.append(
                f"{verdict.name}: joint {joint} ({JOINT_NAMES[joint]}) follows otherwise than the model by "
                f"{1e3 * left:.0f} mrad rms, {100 * share:.0f} % of its tracking error, against {100 * usual:.0f} % "
                "with the controller of the fitted log; what only a stiffer or softer controller shows is missing from "
                f"the model, such as play, load friction, lag or a sagging supply: {FIT_IT}."
            )
    return sentences
