"""The report of a commissioning: one HTML file with what was predicted beside what was measured, round by round."""

from __future__ import annotations

import base64
from pathlib import Path
from typing import Any

import jinja2
import numpy as np

from greywhale.arm.parameters import JOINT_NAMES
from greywhale.base.formats.whole import write_text
from greywhale.commission.measures import Measures
from greywhale.commission.motions import PARTS
from greywhale.commission.result import CommissioningResult, number_text
from greywhale.commission.trials import Trial
from greywhale.files.log import read_evidence

Measure = tuple[str, str, str, float, str]  # name in Measures, words, unit, factor, form
MEASURES: tuple[Measure, ...] = (
    ("unrest", "unrest at rest", "mrad rms", 1e3, ".1f"),
    ("rattle", "rattle in motion", "mrad rms", 1e3, ".1f"),
    ("chatter", "chatter", "1/s", 1.0, ".0f"),
    ("ripple", "ripple at rest, above 20 Hz", "V rms", 1.0, ".2f"),
    ("voltage", "size of the voltage, mean", "V", 1.0, ".2f"),
    ("overshoot", "overshoot of moves", "%", 1.0, ".0f"),
    ("settling", "settling time of moves", "s", 1.0, ".2f"),
)
NOTHING = {"predicted": "-", "measured": "-"}


def save_page(outcome: CommissioningResult, path: Path) -> Path:
    """Write the report, whole or not at all; it needs no other file."""
    environment = jinja2.Environment(
        loader=jinja2.PackageLoader("greywhale.commission", "data"), autoescape=True, undefined=jinja2.StrictUndefined
    )
    write_text(path, environment.get_template("report.html").render(facts(outcome)))
    return path


def facts(outcome: CommissioningResult) -> dict[str, Any]:
    """All that the page shows, as texts."""
    trials = outcome.trials
    rounds = []
    for one in outcome.rounds:
        shown = [_trial(outcome, trial) for trial in one.trials]
        rounds.append({"number": one.number, "doubts": one.learnt.doubts, "trials": shown})
    tried = {id(trial) for one in outcome.rounds for trial in one.trials}
    rest = [_trial(outcome, trial) for trial in trials.done[1:] if id(trial) not in tried]
    return {
        "headline": outcome.headline,
        "text": outcome.text().removeprefix(outcome.headline).strip(),
        "joints": [f"{joint} {JOINT_NAMES[joint]}" for joint in trials.table.joints_in_use],
        "before": _trial(outcome, trials.before),
        "rounds": rounds,
        "confirmations": rest,
        "picture": _picture(outcome),
    }


def _trial(outcome: CommissioningResult, trial: Trial) -> dict[str, Any]:
    predicted = outcome.predicted(trial, outcome.round_of(trial))
    joints = list(outcome.trials.table.joints_in_use)
    rows = []
    for place, part in enumerate(PARTS):
        shown, seen = (1e3 * np.sqrt(one.error[place, joints]) for one in (predicted, trial.measured))
        cells = [_cell(*pair, ".1f") for pair in zip(shown, seen, strict=True)]
        rows.append({"name": f"error, {part}", "unit": "mrad rms", "cells": cells})
    rows += [_row(predicted, trial.measured, measure, joints) for measure in MEASURES]
    return {
        "name": trial.name,
        "log": trial.path.name,
        "stopped": trial.stopped,
        "on_board": trial is outcome.best and trial.table == outcome.table,
        "verdicts": [
            "; ".join(verdict.faults) if verdict.faults else "passed" if verdict.known else "not judged"
            for verdict in (trial.verdicts[joint] for joint in joints)
        ],
        "rows": [row for row in rows if any(cell != NOTHING for cell in row["cells"])],
    }


def _row(predicted: Measures, measured: Measures, measure: Measure, joints: list[int]) -> dict[str, Any]:
    name, means, unit, factor, form = measure
    pairs = zip(factor * predicted.worst(name)[joints], factor * measured.worst(name)[joints], strict=True)
    return {"name": means, "unit": unit, "cells": [_cell(*pair, form) for pair in pairs]}


def _cell(predicted: float, measured: float, form: str) -> dict[str, str]:
    return {"predicted": number_text(predicted, form), "measured": number_text(measured, form)}


def _picture(outcome: CommissioningResult) -> str:
    """Before and after on the check, as a data URL."""
    # Matplotlib takes a second to import.
    from greywhale.pictures.follow import plot_following, trace
    from greywhale.pictures.page import png, style

    chosen = [(outcome.trials.before, "before")]
    if outcome.improved:
        chosen.append((outcome.best, "now on the board"))
    supply_v = outcome.trials.table.supply_v
    with style():
        traces = [trace(read_evidence(trial.path), label, supply_v) for trial, label in chosen]
        picture = png(plot_following(traces, "The check on the arm"))
    return "data:image/png;base64," + base64.b64encode(picture).decode("ascii")
