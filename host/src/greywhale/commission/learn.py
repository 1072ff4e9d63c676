"""From logs to controllers in one round: identify the arm from the evidence so far, and tune on that model."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, field, replace
from pathlib import Path

import numpy as np

from greywhale.arm import ArmParameters
from greywhale.base.types import Controllers, Floats, NotedProgress
from greywhale.commission.evidence import Evidence
from greywhale.commission.journal import AnewError, CommissioningJournal
from greywhale.commission.request import CommissioningRequest
from greywhale.commission.trials import Trial
from greywhale.files import controller as controller_file
from greywhale.identify import IdentificationResult, identify, validated
from greywhale.loop import controller_row
from greywhale.loop.led_model import predict
from greywhale.protocol.firmware import JOINTS
from greywhale.protocol.table import ParameterTable
from greywhale.tune import DEFAULT_BUDGET, TuningResult, tune
from greywhale.tune.model import Model, load_model
from greywhale.tune.report.controller_file import save

# The trials go on with what the search found on the model; a longer one takes more time than it saves.
BUDGET = DEFAULT_BUDGET // 2


@dataclass(frozen=True)
class LearntController:
    """A round's model and controllers (4, 13): the tuned ones, and those that a search on the model made of them; and
    what speaks against the model.
    """

    arm: ArmParameters
    tuned: Controllers
    controllers: Controllers
    doubts: tuple[str, ...]
    steady: bool  # whether all margins hold on the model
    others: dict[str, int] = field(default_factory=dict)  # raw, what the model says of the board's other parameters
    # Scores on the model, (2, 4): of the tuned controllers, and of the others.
    promised: Floats = field(default_factory=lambda: np.full((2, JOINTS), np.nan))

    @property
    def fallback(self) -> Controllers:
        """The tuned controllers; where a joint would follow worse than before with its own, by the model, the other."""
        return np.where((self.promised[0] < 1.0)[:, None], self.tuned, self.controllers)


@dataclass(frozen=True)
class UnvalidatedTuning:
    """A model that is not validated yet (None: it was given), and the controllers tuned on it."""

    model: IdentificationResult | None
    tuning: TuningResult


@dataclass(frozen=True)
class RoundTuner:
    """Identifies and tunes for one round, from what is known by then. It does so once: the journal keeps it."""

    journal: CommissioningJournal
    number: int  # of the round
    options: CommissioningRequest
    nominal: ArmParameters
    fit: Evidence | None  # None: the model is given
    begin: ArmParameters | None  # the model before
    start: Controllers
    failing: Callable[[ArmParameters], Floats]  # plants that show what the arm did and this model would not

    @property
    def path(self) -> Path:
        """The model's file."""
        given = self.options.model if self.fit is None else None
        return self.journal.path(f"model-{self.number}.toml") if given is None else given

    def tune(self, report: NotedProgress) -> UnvalidatedTuning | None:
        """Identify the arm and tune for it; None where the journal has both."""
        if self.journal.get(self._name) is not None:
            return None
        found = None if self.fit is None else self._find_model(self.fit, report)
        tuning = tune(
            self._with_failures(self._model()),
            budget=self.options.budget or BUDGET,
            seed=self.options.seed,
            threads=self.options.threads,
            start=self.start,
            report=report,
            judging=self.options.judging.tuning,
        )
        if not tuning.complete:
            raise KeyboardInterrupt
        return UnvalidatedTuning(found, tuning)

    def validate(self, tuned: UnvalidatedTuning | None, evidence: Evidence) -> tuple[Model, LearntController]:
        """Validate the model and write down what was learnt."""
        if tuned is not None:
            if tuned.model is not None:
                validated(tuned.model, evidence.logs, evidence.tables).save(self.path)
            tuning = replace(tuned.tuning, model=self._with_failures(self._model()))
            save(tuning, self._controllers)
            self.journal.note(self._name, {"steady": tuning.steady, "doubts": list(tuning.model.doubts)})
        model, facts = self._model(), self.journal.get(self._name)
        assert facts is not None
        found = controller_file.load(self._controllers)
        rows, others = controller_row(found), found.other_values()
        return model, LearntController(model.arm, rows, rows, tuple(facts["doubts"]), facts["steady"], others)

    def _find_model(self, fit: Evidence, report: NotedProgress) -> IdentificationResult:
        begin = self.begin if self.begin is not None and "covariance" in (self.begin.identification or {}) else None
        found = identify(
            fit.logs,
            self.nominal,
            tables=fit.tables,
            seed=self.options.seed,
            begin=begin,
            report=report,
            judging=self.options.judging.tuning.identification,
        )
        found.save(self.path)
        if not found.complete:
            raise KeyboardInterrupt
        return found

    def _model(self) -> Model:
        """Its doubts do not refuse it, because the arm itself judges what comes of it."""
        params = self.journal.path("before.toml")
        return load_model(
            self.path, seed=self.options.seed, force=True, params=params, judging=self.options.judging.tuning
        )

    def _with_failures(self, model: Model) -> Model:
        """Return the model with plants added that show what the arm did, where the search and the margins see them."""
        plants = self.failing(model.arm)
        return replace(model, plants=np.vstack([model.plants[:1], plants, model.plants[1:]])) if len(plants) else model

    @property
    def _name(self) -> str:
        return f"controller-{self.number}"

    @property
    def _controllers(self) -> Path:
        return self.journal.path(f"{self._name}.toml")


def refuse_other_arm(
    arm: ArmParameters, name: str, before: Trial, table: ParameterTable, max_model_error: float
) -> None:
    """Refuse a model that does not predict what this arm did with the controllers from before: each joint's way to
    within this share of the tracking error (mean squares).
    """
    shown = predict(arm, table, before.traces)[0]
    apart = np.mean((shown.follower - before.traces.follower) ** 2, axis=0)
    error = np.mean((before.traces.leader - before.traces.follower) ** 2, axis=0)
    shares = apart / np.maximum(error, 1e-9)
    worst = int(np.argmax(shares))
    if shares[worst] > max_model_error:
        raise AnewError(
            f"{name} is a model of another arm: joint {worst} is {np.sqrt(apart[worst]):.3g} rad (rms) away from where "
            f"it should be, though it follows its leader within {np.sqrt(error[worst]):.3g} rad; leave --model out."
        )
