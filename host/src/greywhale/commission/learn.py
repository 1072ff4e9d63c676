"""From logs to controllers in one round: identify the arm from the evidence so far, and tune on that model."""

from __future__ import annotations

from dataclasses import dataclass, field, replace
from pathlib import Path

import numpy as np

from greywhale.arm import ArmParameters
from greywhale.base.errors import UserError
from greywhale.base.types import Controllers, Floats, NotedProgress
from greywhale.commission.evidence import Evidence
from greywhale.commission.journal import CommissioningJournal
from greywhale.commission.predict import predict
from greywhale.commission.trials import Trial
from greywhale.files import controller as controller_file
from greywhale.identify import identify
from greywhale.protocol.table import ParameterTable
from greywhale.simulate import controller_row
from greywhale.tune import DEFAULT_BUDGET, tune
from greywhale.tune.model import Model, load_model
from greywhale.tune.report.controller_file import save

# The trials go on with what the search found on the model; a longer one takes more time than it saves.
BUDGET = DEFAULT_BUDGET // 2
# A model of this arm predicts each joint's way to within this share of the tracking error (mean squares).
MOST_APART = 0.5


@dataclass(frozen=True)
class LearntController:
    """A round's model and controllers (4, 13), and what speaks against the model."""

    arm: ArmParameters
    controllers: Controllers
    doubts: tuple[str, ...]
    steady: bool  # whether all margins hold on the model
    others: dict[str, int] = field(default_factory=dict)  # raw, what the model says of the board's other parameters


def find_model(
    book: CommissioningJournal,
    name: str,
    nominal: ArmParameters,
    known: Evidence,
    seed: int,
    report: NotedProgress,
    begin: ArmParameters | None = None,
) -> Path:
    """Identify the arm, or take the model of that name from the journal; its file. `begin` is the model before."""
    path = book.path(f"{name}.toml")
    if book.get(name) is None:
        outcome = identify(
            known.fit,
            nominal,
            validate=known.validate,
            tables=known.tables,
            seed=seed,
            begin=begin if begin is not None and "covariance" in (begin.identification or {}) else None,
            report=report,
        )
        outcome.save(path)
        if not outcome.complete:
            raise KeyboardInterrupt
        book.note(name, {"improvement": [round(one.improvement, 4) for one in outcome.verdicts]})
    return path


def find_controllers(
    book: CommissioningJournal,
    name: str,
    model: Model,
    *,
    start: Controllers,
    budget: int,
    seed: int,
    threads: int,
    report: NotedProgress,
) -> LearntController:
    """Tune on a model, or take the controllers of that name from the journal. An interrupted search goes on."""
    path, journal = book.path(f"{name}.toml"), book.path(f"{name}.toml.journal")
    known = book.get(name)
    if known is None:
        outcome = tune(
            model,
            budget=budget,
            seed=seed,
            threads=threads,
            start=start,
            journal=journal,
            resume=journal.exists(),
            report=report,
            floors=False,
            on_trial=True,
        )
        if not outcome.complete:
            raise KeyboardInterrupt
        save(outcome, path)
        journal.unlink(missing_ok=True)
        known = {"steady": outcome.steady, "doubts": list(model.doubts)}
        book.note(name, known)
    found = controller_file.load(path)
    others = found.other_values()
    return LearntController(model.arm, controller_row(found), tuple(known["doubts"]), known["steady"], others)


def read_model(path: Path, seed: int, params: Path) -> Model:
    """A model to tune for. Its doubts do not refuse it, because the arm itself judges what comes of it."""
    return load_model(path, seed=seed, force=True, params=params)


def with_failures(model: Model, plants: Floats) -> Model:
    """The same model with plants that show what the arm did, where the search and the margins see them."""
    return replace(model, plants=np.vstack([model.plants[:1], plants, model.plants[1:]])) if len(plants) else model


def refuse_other_arm(arm: ArmParameters, name: str, before: Trial, table: ParameterTable) -> None:
    """Refuse a model that does not predict what this arm did with the controllers from before."""
    shown = predict(arm, table, before.traces)[0]
    apart = np.mean((shown.follower - before.traces.follower) ** 2, axis=0)
    error = np.mean((before.traces.leader - before.traces.follower) ** 2, axis=0)
    shares = apart / np.maximum(error, 1e-9)
    worst = int(np.argmax(shares))
    if shares[worst] > MOST_APART:
        raise UserError(
            f"{name} is a model of another arm: joint {worst} is {np.sqrt(apart[worst]):.3g} rad (rms) away from where "
            f"it should be, though it follows its leader within {np.sqrt(error[worst]):.3g} rad; leave --model out."
        )
