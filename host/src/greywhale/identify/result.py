"""The outcome of an identification, as numbers, as text for people and as model.toml."""

from __future__ import annotations

from dataclasses import dataclass, field
from pathlib import Path
from typing import NotRequired, TypedDict

import numpy as np

from greywhale.arm import ArmParameters
from greywhale.arm.from_plant import arm_of
from greywhale.base.formats.whole import write_text
from greywhale.base.telling import Column, Part, Row, Sentences, Table, Telling
from greywhale.base.types import Crc, Floats
from greywhale.files.model import sealed, to_toml
from greywhale.identify.combinations import CombinationFacts
from greywhale.identify.data import pot_noise
from greywhale.identify.found_model import EstimateFacts, FoundModel, ParameterEstimate, RivalFacts
from greywhale.identify.judge import FIT, JudgedLog, LogVerdict, VerdictFacts
from greywhale.identify.uncertainty import LARGEST_CONDITION
from greywhale.protocol.joints import Joints


class OriginFacts(TypedDict):
    parameter_crc: NotRequired[Crc]
    period_ms: NotRequired[int]  # of the control


class LogFacts(OriginFacts, VerdictFacts):
    name: str
    role: str  # fit, validation, or validation, changed controller


class OrderFacts(TypedDict):
    order: str  # the groups of parameters that were admitted
    held_out_error: float  # on the held-out windows


class KnownFacts(TypedDict):
    fisher_condition: NotRequired[float]  # condition number of the Fisher information; 1e13 means at least that
    covariance: NotRequired[list[list[float]]]  # over the searched numbers, in the order of `parameter`
    parameters: NotRequired[dict[str, int]]  # raw, of the logs, that differ from the defaults
    board: NotRequired[str]  # mega2560 or nano328


class TriedFacts(TypedDict):
    orders_tried: NotRequired[list[OrderFacts]]  # the models that were compared on windows held out of the fit
    rival: NotRequired[list[RivalFacts]]  # orders that are nearly as good
    combination: NotRequired[list[CombinationFacts]]  # quotients and products that are surer than their numbers


class IdentificationFacts(KnownFacts, TriedFacts):
    status: str  # complete, or unfinished with the reason
    method: str  # default, or the paper's
    seed: int
    white_box: str  # the arm that it began with
    simulations: int  # candidates
    simulated_s: float
    order: str  # the groups of parameters that were admitted
    not_identified: list[str]  # what the logs leave open, and which motion would settle it
    warnings: list[str]  # about the logs, and about the fit
    doubts: list[str]  # why tune would refuse the model
    log: list[LogFacts]  # those of the fit first
    parameter: list[EstimateFacts]  # the numbers that were searched


class ResultFacts(IdentificationFacts):
    convergence: list[float]  # costs of a method that has one


@dataclass(frozen=True)
class IdentificationResult:
    """A model, how certain it is, and how it does on every log."""

    white_box: ArmParameters
    method: str
    seed: int
    found: FoundModel
    verdicts: tuple[LogVerdict, ...]
    warnings: tuple[str, ...]
    doubts: tuple[str, ...]  # about joints that the model does not understand; `tune` refuses such a model
    subjects: tuple[JudgedLog, ...] = field(repr=False)

    @property
    def plant(self) -> Floats:
        """(columns,)"""
        return self.found.plant

    @property
    def zero(self) -> Floats:
        """(4,) rad, the angles at which the follower's potentiometers read 0."""
        return self.found.zero

    @property
    def estimates(self) -> tuple[ParameterEstimate, ...]:
        """The searched numbers in physical units."""
        return self.found.estimates

    @property
    def complete(self) -> bool:
        """True where nobody interrupted the search."""
        return self.found.complete

    @property
    def arm(self) -> ArmParameters:
        """The model as an arm that can be simulated."""
        begun = self.white_box.name.removesuffix(" (unfinished)").removesuffix(", identified")
        name = f"{begun}, identified" + ("" if self.complete else " (unfinished)")
        source = f"greywhale identify, method {self.method}"
        return arm_of(self.white_box, self.plant, self.zero, name, source, self._noise())

    def _noise(self) -> Floats | None:
        """The potentiometers' noise, V rms, where a fitted log shows it; the noisiest log counts."""
        supply = self.white_box.follower_pots.supply
        found = [
            pot_noise(one.log, one.table["filter_shift"], supply)
            for one in self.subjects
            if one.role == FIT and one.table is not None and one.log.log.origin.firmware is not None
        ]
        return np.max(found, axis=0) if found else None

    def save(self, path: str | Path) -> None:
        """Write model.toml."""
        write_text(path, to_toml(self.arm, sealed(self.arm, self.identification())))

    def identification(self) -> IdentificationFacts:
        """The table [identification] of model.toml; it is also the JSON."""
        return {
            "status": "complete" if self.complete else "unfinished: interrupted; the best model so far",
            "method": self.method,
            "seed": self.seed,
            "white_box": self.white_box.name,
            "simulations": self.found.simulations,
            "simulated_s": self.found.simulated,
            "order": self.found.order,
            **self._known(),
            "not_identified": list(self.found.open),
            "warnings": list(self.warnings),
            "doubts": list(self.doubts),
            "log": [self._log(*pair) for pair in zip(self.subjects, self.verdicts, strict=True)],
            **self._tried(),
            "parameter": [one.as_dict() for one in self.estimates],
        }

    def _known(self) -> KnownFacts:
        facts: KnownFacts = {}
        if self.found.condition is not None:
            facts["fisher_condition"] = self.found.condition
        if self.found.covariance is not None:
            facts["covariance"] = self.found.covariance.tolist()
        table = next((one.table for one in self.subjects if one.role == FIT and one.table is not None), None)
        if table is not None:
            facts["parameters"] = table.changes()
        board = next((one.log.log.origin.board for one in self.subjects if one.role == FIT), None)
        if board is not None:
            facts["board"] = board
        return facts

    def _tried(self) -> TriedFacts:
        facts: TriedFacts = {}
        if self.found.orders:
            facts["orders_tried"] = [{"order": order, "held_out_error": error} for order, error in self.found.orders]
        if self.found.rivals:
            facts["rival"] = [one.as_dict() for one in self.found.rivals]
        if self.found.combinations:
            facts["combination"] = [one.as_dict() for one in self.found.combinations]
        return facts

    @staticmethod
    def _log(subject: JudgedLog, verdict: LogVerdict) -> LogFacts:
        origin, known = subject.log.log.origin, OriginFacts()
        if origin.param_crc is not None:
            known["parameter_crc"] = f"0x{origin.param_crc:04x}"
        if origin.period_ms is not None:
            known["period_ms"] = origin.period_ms
        return {"name": verdict.name, "role": verdict.role, **known, **verdict.as_dict()}

    def as_dict(self) -> ResultFacts:
        return {**self.identification(), "convergence": list(self.found.curve)}

    @property
    def begun(self) -> str:
        """The name of the arm that the search began with: only one that nobody identified is a white box."""
        return "white box" if self.white_box.identification is None else "model before"

    def tell(self) -> list[Part]:
        """The result for people: the layout of the paper's Table 5, then what is known and what is not."""
        unfinished = "UNFINISHED: interrupted; this is the best model so far."
        parts: list[Part] = [] if self.complete else [Sentences([unfinished], grave=True)]
        parts += [_table(verdict, self.begun, self.white_box.joints_in_use) for verdict in self.verdicts]
        if self.found.condition is not None:
            parts += self._tell_numbers(self.found.condition)
        if self.found.combinations:
            known = [
                f"{one.name} = {one.value:.4g} +- {100.0 * one.deviation:.2g} %" for one in self.found.combinations
            ]
            parts.append(Sentences(known, "Better known together than one by one", listed=True))
        if self.found.open:
            parts.append(Sentences(self.found.open, "What these logs leave uncertain", listed=True))
        for title, sentences in (("Warnings", self.warnings), ("Doubts", self.doubts)):
            if sentences:
                parts.append(Sentences(sentences, title, listed=True, grave=True))
        return parts

    def text(self) -> str:
        return Telling(self.tell()).text()

    def _tell_numbers(self, condition: float) -> list[Part]:
        """The searched numbers, and how well they are known."""
        least = "at least " if condition >= LARGEST_CONDITION else ""
        rivals = "; ".join(rival.order for rival in self.found.rivals)
        lines = [
            *([f"Nearly as good: {rivals}."] if rivals else []),
            f"Model order: {self.found.order} (by held-out data).",
            f"Condition number of the Fisher information: {least}{condition:.2g}. So the best known combination of "
            f"parameters is {least}{condition**0.5:,.0f} times as well known as the least known.",
        ]
        columns = (
            Column("parameter", width=18, left=True),
            *(Column(self.begun, width=12), Column("model", width=11), Column("std", width=9)),
            Column("unit", left=True),
        )
        rows = []
        for one in self.estimates:
            deviation = "" if one.deviation is None else f"{one.deviation:.2g}"
            rows.append(Row((one.name, f"{one.white_box:.4g}", f"{one.value:.4g}", deviation, one.unit)))
        return [Sentences(lines), Table(columns, rows)]


def _table(verdict: LogVerdict, begun: str, joints: Joints) -> Table:
    columns = (Column("MSE", "rad²", 12, left=True), Column(begun, width=12), Column("model", width=12))
    before, after = sum(verdict.white_box), sum(verdict.model)
    rows = [
        Row(
            (f"joint {one}", f"{verdict.white_box[one]:.3g}", f"{verdict.model[one]:.3g}"),
            remark=f"off by {verdict.rms_mrad[one]:.2g} mrad rms",
        )
        for one in joints
    ]
    total = Row(("all joints", f"{before:.3g}", f"{after:.3g}"), remark=_comparison(verdict, begun))
    return Table(columns, [*rows, total], f"{verdict.name} ({verdict.role}; {verdict.measure})")


def _comparison(verdict: LogVerdict, begun: str) -> str:
    if verdict.is_as_good:
        return f"as good as the {begun}, as far as noise lets tell"
    return f"{verdict.comparison}{'; these logs decide nothing' if verdict.is_undecided else ''}"
