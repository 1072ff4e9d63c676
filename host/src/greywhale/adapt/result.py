"""The outcome of an adaptation: the sets that ran on trial, what came of each, and what the board runs now."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TypedDict

from greywhale.adapt.decide import Outcome, TriedSet
from greywhale.base.telling import Part, Sentences, Telling
from greywhale.base.types import Crc
from greywhale.protocol.table import ParameterTable


class TriedFacts(TypedDict):
    parameter_crc: Crc  # of the set that ran
    begun_s: float  # by the board's clock
    seconds: float  # how long it was judged
    predicted: float  # error as a share of that of the set before, by the model
    ratio: float | None  # the same as measured; null where it ended too soon
    low: float | None  # where the ratio lies with 98 %
    high: float | None
    outcome: Outcome
    why: str


class AdaptationFacts(TypedDict):
    seconds: float  # of work
    searches: int  # in the background
    changes: int  # of the running set
    bump_rad: float  # by which a joint's error grew in a change, at most, while its leader rested
    trials: list[TriedFacts]
    model: dict[str, float]  # what each number became, as a multiple of the file's; of the load (arm.tip), kg more
    improved: bool  # whether a set was kept
    stored: bool  # whether the board stores it; otherwise it runs and stores the set from the start
    parameter_crc: Crc  # of what the board stores
    note: str  # why nothing more is tried; empty for nothing to say


class AdaptAnswer(AdaptationFacts):
    port: str  # the serial port that was used
    out: str | None  # file with the controllers that were kept; null: none were


@dataclass(frozen=True)
class AdaptationResult:
    """`start` ran at the start, `kept` is what the adaptation ends with; whether that is `stored` was decided after."""

    start: ParameterTable
    kept: ParameterTable
    trials: tuple[TriedSet, ...]
    seconds: float
    searches: int
    changes: int
    bump_rad: float
    model: dict[str, float]
    note: str
    stored: bool = False

    @property
    def improved(self) -> bool:
        return self.kept.controllers != self.start.controllers

    def as_dict(self) -> AdaptationFacts:
        return {
            "seconds": round(self.seconds, 3),
            "searches": self.searches,
            "changes": self.changes,
            "bump_rad": round(self.bump_rad, 5),
            "trials": [_facts(one) for one in self.trials],
            "model": {name: round(ratio, 3) for name, ratio in self.model.items()},
            "improved": self.improved,
            "stored": self.stored,
            "parameter_crc": f"0x{(self.kept if self.stored else self.start).crc:04x}",
            "note": self.note,
        }

    def tell(self) -> list[Part]:
        """The result for people."""
        work = f"{self.seconds:.0f} s of work, searches: {self.searches}, sets on trial: {len(self.trials)}."
        lines = []
        if self.note:
            lines.append(f"At the end: {self.note}.")
        if self.changes:
            lines.append(f"A change of sets made an error grow by {1e3 * self.bump_rad:.1f} mrad at most.")
        lines.append(self._ending())
        trials = [f"at {one.begun_s:.0f} s: {say(one)}" for one in self.trials]
        return [Sentences([work]), Sentences(trials, listed=True, near=True), Sentences(lines, near=True)]

    def text(self) -> str:
        return Telling(self.tell()).text()

    def _ending(self) -> str:
        if not self.improved:
            return "The board keeps the controllers from before."
        if self.stored:
            return "The board runs and stores the controllers that were kept."
        return "The board runs the controllers from before again; those that were kept are in the file."


def say(tried: TriedSet) -> str:
    """Say how a trial ended, in a clause."""
    if tried.outcome is Outcome.KEPT:
        return (
            f"a set was kept: {tried.why} ({100 * (1 - tried.predicted):.0f} % less predicted, {tried.seconds:.0f} s)"
        )
    return f"a set was taken back: {tried.why}"


def _facts(tried: TriedSet) -> TriedFacts:
    return {
        "parameter_crc": f"0x{tried.crc:04x}",
        "begun_s": round(tried.begun_s, 3),
        "seconds": tried.seconds,
        "predicted": round(tried.predicted, 4),
        "ratio": _rounded(tried.ratio),
        "low": _rounded(tried.low),
        "high": _rounded(tried.high),
        "outcome": tried.outcome,
        "why": tried.why,
    }


def _rounded(value: float | None) -> float | None:
    return None if value is None else round(value, 4)
