"""The demo's results: the measures of every run side by side, for people and as JSON."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from pathlib import Path
from typing import NotRequired, TypedDict

from greywhale.arm.parameters import JOINT_NAMES
from greywhale.base.types import Crc
from greywhale.cli.story.learn import Learnt
from greywhale.cli.story.recorder import Recorded
from greywhale.measure import Evaluation, JointMeasures, more_overshoot
from greywhale.measure.evaluate import EvaluationFacts

TUNED = "tuned"  # the run with the controllers that were tuned on the model

Measure = tuple[str, Callable[[JointMeasures], str]]  # heading, and a joint's cell
MEASURES: tuple[Measure, ...] = (
    ("MSE [rad²]", lambda joint: f"{joint.mse:.6f}"),
    ("steady-state error [rad]", lambda joint: _cell(joint.steady_state_error, ".4f")),
    ("settling error [rad]", lambda joint: _cell(joint.settling_error, ".4f")),
    ("time delay [s]", lambda joint: _cell(joint.delay_s, ".3f")),
    ("overshoot [%]", lambda joint: _cell(joint.overshoot_percent, ".1f")),
    ("settling time [s]", lambda joint: joint.settling(".2f") or "-"),
)


class RunFacts(TypedDict):
    controllers: str  # which
    log: str  # the file
    parameter_crc: Crc
    samples: int  # rows of the log
    dropped: int  # samples that the link lost
    measures: EvaluationFacts  # as `greywhale evaluate` measures the log


class LearntFacts(TypedDict):
    model: str  # file
    controller: str  # file
    identify_s: float  # wall time
    tune_s: float
    upload_s: NotRequired[float]  # not where the motion with the tuned controllers was left out
    improvement_of_the_model: list[float]  # over the arm's drawings, a share, on each log, the fitted one first
    doubts: list[str]  # about the model


class DemoAnswer(TypedDict):
    leader: str  # the motion
    board: str  # mega2560 or nano328
    firmware: str  # version
    runs: list[RunFacts]  # the same motion with each set of controllers
    left_out: list[str]  # motions in which the board stopped the arm, and why
    pictures: list[str]  # files
    wall_s: float
    learnt: NotRequired[LearntFacts]  # not with --controller


@dataclass(frozen=True)
class Run:
    name: str
    recorded: Recorded
    measures: Evaluation

    def as_dict(self) -> RunFacts:
        return {
            "controllers": self.name,
            "log": str(self.recorded.path),
            "parameter_crc": f"0x{self.recorded.param_crc:04x}",
            "samples": self.recorded.samples,
            "dropped": self.recorded.dropped,
            "measures": self.measures.as_dict(),
        }


@dataclass(frozen=True)
class DemoResult:
    """All runs of the demo that came to their end; `learnt` where controllers were tuned in it."""

    leader: str
    board: str
    firmware: str
    runs: tuple[Run, ...]
    learnt: Learnt | None
    left_out: tuple[str, ...]  # motions in which the board stopped the arm, and why
    pictures: tuple[Path, ...]
    wall_s: float

    def as_dict(self) -> DemoAnswer:
        facts: DemoAnswer = {
            "leader": self.leader,
            "board": self.board,
            "firmware": self.firmware,
            "runs": [run.as_dict() for run in self.runs],
            "left_out": list(self.left_out),
            "pictures": [str(picture) for picture in self.pictures],
            "wall_s": round(self.wall_s, 1),
        }
        if self.learnt is not None:
            facts["learnt"] = {
                "model": str(self.learnt.model),
                "controller": str(self.learnt.controller),
                "identify_s": round(self.learnt.identify_s, 1),
                "tune_s": round(self.learnt.tune_s, 1),
                "improvement_of_the_model": [one.improvement for one in self.learnt.identification.verdicts],
                "doubts": list(self.learnt.tuning.model.doubts),
            }
            if (upload_s := self._upload_s()) is not None:
                facts["learnt"]["upload_s"] = round(upload_s, 1)
        return facts

    def _upload_s(self) -> float | None:
        return next((run.recorded.upload_s for run in self.runs if run.name == TUNED), None)

    def text(self) -> str:
        """A table a person can read, and where the files are."""
        parts = [f"Leader: {self.leader}. Board: {self.board}, firmware {self.firmware}."]
        if self.learnt is not None:
            parts.append(self._story(self.learnt))
        parts += [f"Left out, {reason}" for reason in self.left_out]
        parts += [self._table(*measure) for measure in MEASURES]
        if more := more_overshoot(self.runs[0].measures, self.runs[-1].measures):
            parts.append(f"MORE OVERSHOOT than before: {more}.")
        files = ", ".join(str(run.recorded.path) for run in self.runs)
        parts.append(f"Pictures: {', '.join(map(str, self.pictures))}\nLogs: {files}")
        return "\n\n".join(parts)

    def _story(self, learnt: Learnt) -> str:
        fit, *others = learnt.identification.verdicts
        checked = " and ".join(f"{100 * verdict.improvement:.0f} %" for verdict in others or (fit,))
        seen = "recordings that it had not seen" if others else "the recording that it was found from"
        upload_s = self._upload_s()
        uploaded = "" if upload_s is None else f", uploaded in {upload_s:.1f} s"
        lines = [
            f"Identified from {Path(fit.name).name} in {learnt.identify_s:.0f} s: the error of {learnt.model} is "
            f"{checked} lower than that of the arm's drawings, on {seen}.",
            f"Tuned on that model in {learnt.tune_s:.0f} s: {learnt.controller}{uploaded}. The motion below was used "
            "for neither.",
            *learnt.tuning.worse_sentences,
            *(f"Doubt: {doubt}" for doubt in learnt.tuning.model.doubts),
        ]
        return "\n".join(lines)

    def _table(self, heading: str, cell_of: Callable[[JointMeasures], str]) -> str:
        width = max(14, *(len(run.name) + 2 for run in self.runs))
        lines = [f"{heading:<26}" + "".join(f"{run.name:>{width}}" for run in self.runs)]
        for joint in self.runs[0].measures.joints_in_use:
            cells = (cell_of(run.measures.joints[joint]) for run in self.runs)
            lines.append(f"  {joint} {JOINT_NAMES[joint]:<22}" + "".join(f"{cell:>{width}}" for cell in cells))
        if heading == MEASURES[0][0]:
            totals = (f"{run.measures.total_mse:.6f}" for run in self.runs)
            lines.append(f"  {'all joints':<24}" + "".join(f"{cell:>{width}}" for cell in totals))
        return "\n".join(lines)


def _cell(value: float | None, form: str) -> str:
    return "-" if value is None else f"{value:{form}}"
