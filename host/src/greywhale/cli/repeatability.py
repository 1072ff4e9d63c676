"""The telling of `greywhale evaluate --repeatability`: how exactly arms came back to poses, log by log and beside."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from pathlib import Path
from typing import NotRequired, TypedDict

from greywhale.arm import ArmParameters
from greywhale.base.errors import counted
from greywhale.base.telling import Column, Part, Row, Sentences, Table
from greywhale.files.log import Log
from greywhale.measure.limits import REPEATABILITY_LIMITS
from greywhale.measure.repeatability import Repeatability, RepeatabilityFacts, hidden_play, repeatability

_COLUMNS = (
    Column("", width=13, left=True),
    Column("visits\nfrom a side", width=11),
    Column("repeatability\nRP", width=13),
    Column("accuracy\nAP", width=8),
    Column("lost motion\nvAP", width=11),
)
_BESIDE = Column("moved beside\nthe first log", width=12)
_UNSEEN = (
    "This is where the follower's potentiometers are. They see no play between themselves and the joints, and no link "
    "that bends: a dial gauge at the tip does."
)


class VisitsFacts(RepeatabilityFacts):
    log: str  # the file
    remarks: list[str]  # check, gaps and missing voltages in sentences
    # From the first log: the farthest that the mean places of a joint (by its number, rad) or of the tip (m) are apart
    # in one pose from one side.
    moved: dict[str, float]


class RepeatabilityAnswer(TypedDict):
    logs: list[VisitsFacts]  # in the order given
    picture: NotRequired[str]  # with --picture


class Measured:
    """Logs and their measures, in the order given; the first is the one that others are compared with."""

    def __init__(self, arm: ArmParameters | None) -> None:
        self.arm = arm
        self.logs: list[Log] = []
        self.measures: list[Repeatability] = []

    def take(self, log: Log) -> None:
        self.measures.append(repeatability(log, self.arm))
        self.logs.append(log.without_samples())

    def facts(self, number: int, remarks: list[str]) -> VisitsFacts:
        moved = {"tip" if one is None else str(one): size for one, size in self._moved(number).items()}
        return {"log": self.logs[number].name, "remarks": remarks, "moved": moved, **self.measures[number].as_dict()}

    def tell(self, number: int, remarks: Sequence[str]) -> Iterator[Part]:
        log, found = self.logs[number], self.measures[number]
        yield Sentences(
            [f"{log.name}: {counted(len(found.poses), 'pose')}; the worst of them and of both sides counts"]
        )
        moved = self._moved(number)
        rows = []
        for one, worst in found.worst().items():
            sizes = [worst.repeatability, worst.accuracy, worst.variation, *([moved.get(one)] if number else [])]
            rows.append(Row([_name(one), f"{worst.visits}", *map(_size, sizes)]))
        yield Table((*_COLUMNS, _BESIDE) if number else _COLUMNS, rows, near=True)
        unsettled = [
            f"Joint {joint} had not come to rest in {counted(count, 'visit')}, which it is left out of."
            for joint, count in found.unsettled.items()
        ]
        if number and not moved:
            unsettled.append(f"It visits no pose of {self.logs[0].name} from the same side.")
        yield Sentences([*unsettled, *(f"Warning: {one}" for one in remarks)], grave=True, near=True)

    def tell_unseen(self) -> Part:
        """A word on what potentiometers do not see, and as far as the arm file knows it, how much that is."""
        lines = [_UNSEEN]
        if self.arm is not None:
            poses = [pose.angles for one in self.measures for pose in one.poses]
            joints, tip = hidden_play(self.arm, poses)
            named = [f"joint {joint} {_size(size)} mrad" for joint, size in joints.items()]
            if named:
                lines.append(
                    f"By the arm file, play beside the potentiometers hides this much between both sides: "
                    f"{', '.join(named)}; up to {_size(tip)} mm at the tip."
                )
        return Sentences(lines)

    def _moved(self, number: int) -> dict[int | None, float]:
        """From the first log, from which that one has not moved."""
        return {} if number == 0 else self.measures[number].moved_from(self.measures[0], REPEATABILITY_LIMITS)


def draw(picture: Path, measured: Measured) -> None:
    # Matplotlib takes a second to import, and most evaluations draw nothing.
    from greywhale.pictures.names import distinct_names
    from greywhale.pictures.repeatability import draw_repeatability

    names = distinct_names([log.name for log in measured.logs])
    draw_repeatability(picture, dict(zip(names, measured.measures, strict=True)))


def _name(joint: int | None) -> str:
    return "tip, mm" if joint is None else f"joint {joint}, mrad"


def _size(value: float | None) -> str:
    return "n/a" if value is None else f"{1e3 * value:.2f}"  # mrad and mm
