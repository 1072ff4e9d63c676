"""Section 3 and sections 5.3 and 5.4 on the bench: identify from logs, tune on that model, try on the arm."""

from __future__ import annotations

import tempfile
from pathlib import Path
from typing import Any

from greywhale.arm.plants import plant_row
from greywhale.files.arm import load_arm
from greywhale.identify import IdentificationResult, identify
from greywhale.identify.closed_loop import COMPARED_TICKS, Loop
from greywhale.tune import tune
from greywhale.tune.limits import WITHOUT_FLOORS
from greywhale.tune.model import Model, load_model
from greywhale_paper.work.arms import DEFAULT
from greywhale_paper.work.bench import record_data, try_controllers
from greywhale_paper.work.grey_box import setting, tune_as_paper
from greywhale_paper.work.motions import judged, measures, printed, rounded

# A picture of an identification shows every so many of the compared rows.
SHOWN_EVERY = 4


def identify_on_bench(
    seed: int, seconds: float, period_ms: int, method: str, traces: bool = False, arm: str = DEFAULT, hand: int = 0
) -> dict[str, Any]:
    """A model from data set 1, judged on all three; with it the text of its model.toml."""
    logs, tables = record_data(seconds, period_ms, arm, hand)
    outcome = identify(logs[:1], load_arm("white_box"), validate=logs[1:], tables=tables, method=method, seed=seed)
    _require_whole(outcome.complete)
    found = _facts(outcome)
    if traces:
        found["responses"] = [_responses(outcome, place) for place in range(2)]
    with tempfile.TemporaryDirectory() as made:
        path = Path(made) / "model.toml"
        outcome.save(path)
        found["model"] = path.read_text(encoding="utf-8")
    return found


def _require_whole(complete: bool) -> None:
    """Identification and tuning answer an interrupt with the best so far, which is no result here."""
    if not complete:
        raise KeyboardInterrupt


def _facts(outcome: IdentificationResult) -> dict[str, Any]:
    return {
        "estimates": {one.name: one.value for one in outcome.estimates},
        "curve": [float(cost) for cost in outcome.found.curve],
        "simulations": outcome.found.simulations,
        "order": outcome.found.order,
        "condition": outcome.found.condition,
        "motors": [joint.motor.model_dump() for joint in outcome.arm.joint],
        "plant": outcome.plant.tolist(),
        "white_box": [list(one.white_box) for one in outcome.verdicts],
        "mse": [list(one.model) for one in outcome.verdicts],
        "doubts": list(outcome.doubts),
    }


def _responses(outcome: IdentificationResult, place: int) -> dict[str, Any]:
    subject = outcome.subjects[place]
    assert subject.table is not None
    loop = Loop(subject.log, subject.table, outcome.white_box)
    own = loop.with_zero(outcome.zero) if outcome.zero.any() else loop
    white = loop.angles(plant_row(outcome.white_box)[None])[0]
    model = own.angles(outcome.plant[None])[0]
    rows = slice(None, len(model), SHOWN_EVERY)
    step = COMPARED_TICKS
    return {
        "time": rounded(loop.time[::step][rows]),
        "leader": rounded(loop.leader[::step][rows]),
        "recorded": rounded(loop.follower[::step][rows]),
        "white box": rounded(white[rows]),
        "model": rounded(model[rows]),
    }


def follow_as_paper(
    seed: int, seconds: float, period_ms: int, traces: bool = False, arm: str = DEFAULT
) -> dict[str, Any]:
    """The paper from section 3 to section 5.4: its identification, its tuning of the sets, steps and multi-steps."""
    found = {"identified": identify_on_bench(seed, seconds, period_ms, "paper", traces, arm)}
    model = _model(found["identified"]["model"], seed)
    method, tuned = tune_as_paper(model, "mf", seed)
    controllers = {"before": printed("before_tuning"), "after": method.found.best}
    table, plant = setting(model, float(model.arm.drive.supply))
    found["tuned"] = tuned
    found["simulated"] = judged(model.arm, table, plant, controllers)
    found["measured"] = try_controllers(0, tuned["controllers"], table.period_ms, traces, arm)
    found["measured, own period"] = try_controllers(0, tuned["controllers"], period_ms, False, arm)
    return found


def follow_as_default(seed: int, seconds: float, period_ms: int, budget: int | None, traces: bool) -> dict[str, Any]:
    """The same with greywhale's own identification and tuning, at the board's own control period."""
    found = {"identified": identify_on_bench(seed, seconds, period_ms, "default", traces)}
    model = _model(found["identified"]["model"], seed)
    outcome = tune(model, budget=budget, seed=seed, threads=1, start=printed("before_tuning"), judging=WITHOUT_FLOORS)
    _require_whole(outcome.complete)
    found["tuned"] = {
        "controllers": outcome.after.tolist(),
        "cost_before": list(outcome.cost_before),
        "cost": list(outcome.cost_after),
        "curves": [{"evaluations": list(one.evaluations), "cost": list(one.cost)} for one in outcome.curves],
        "margins": [one.as_dict() for one in outcome.margins if not one.holds],
    }
    found["simulated"] = {
        one.name: {"before": measures(one.before), "after": measures(one.after)}
        for one in outcome.held_out
        if one.name in ("steps", "multi-steps")
    }
    found["measured"] = try_controllers(0, outcome.after.tolist(), outcome.period_ms, traces)
    return found


def _model(text: str, seed: int) -> Model:
    with tempfile.TemporaryDirectory() as made:
        path = Path(made) / "model.toml"
        path.write_text(text, encoding="utf-8")
        return load_model(path, seed=seed, force=True)
