"""controller.toml as a tuning writes it: the board's own numbers, where they come from, and what to expect of them.

Everything in it follows from the outcome. It holds no date and no time of day, so equal tunings give equal files.
"""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from pathlib import Path
from typing import Any

from greywhale.arm.parameters import JOINT_NAMES
from greywhale.files import controller
from greywhale.tune.judge.held_out import HeldOut
from greywhale.tune.judge.margins import Margin
from greywhale.tune.report.summary import failing_margins, overshooting
from greywhale.tune.result import TuningResult


def save(outcome: TuningResult, path: str | Path) -> None:
    """Write controller.toml, whole or not at all."""
    notes = [_note(outcome, joint) for joint in range(len(JOINT_NAMES))]
    controller.save(
        path,
        outcome.after,
        _source(outcome),
        header=_header(outcome),
        notes=notes,
        travel=None if outcome.model.travel is None else outcome.model.travel.raw(),
        tuning=provenance(outcome),
    )


def provenance(outcome: TuningResult) -> dict[str, Any]:
    """The table [tuning]: how the controllers were found, and what to expect of each joint."""
    model = outcome.model
    facts: dict[str, Any] = {
        "status": "complete" if outcome.complete else "unfinished: interrupted; the best so far",
        "method": outcome.method,
        "strategy": outcome.strategy,
        "seed": outcome.seed,
        "budget": outcome.budget,
        "evaluations": outcome.evaluations,
        "model": model.name,
        "model_sha256": model.digest,
        "plants": len(model.plants),
        "board": outcome.table.board.key,
        "period_ms": outcome.period_ms,
        "supply_v": outcome.supply_v,
        "parameter_crc": f"0x{outcome.board_table.crc:04x}",
        "doubts": list(model.doubts),
        "notes": list(outcome.notes),
        "cost_before": _rounded(outcome.cost_before),
        "cost_after": _rounded(outcome.cost_after),
    }
    # An unfinished tuning was not judged.
    if outcome.margins:
        facts |= {"margins_hold": outcome.steady, "margin": _margins(outcome.margins)}
    if outcome.worse:
        facts["follows_worse"] = [one.words for one in outcome.worse]
    if outcome.held_out:
        facts["expected"] = [_expected(one) for one in outcome.held_out]
    return facts


def _source(outcome: TuningResult) -> str:
    how = f"method {outcome.method}, strategy {outcome.strategy}, seed {outcome.seed}"
    return f"greywhale tune, {how}, for {outcome.model.name}" + ("" if outcome.complete else " (unfinished)")


def _header(outcome: TuningResult) -> list[str]:
    lines = [
        "Written by greywhale tune. Exactly what was simulated: greywhale upload stores these numbers as they are.",
        f"For a control period of {outcome.period_ms} ms and a supply of {outcome.supply_v:g} V.",
    ]
    if not outcome.complete:
        lines.append("UNFINISHED: interrupted; these are the best so far. The same command with --resume goes on.")
    if outcome.model.travel is not None:
        lines.append(f"For the board: {outcome.model.travel.sentence}")
    lines += [f"Expected on {one.name}, all joints: {_change(one)}." for one in outcome.held_out]
    lines += [*outcome.worse_sentences, *overshooting(outcome), *failing_margins(outcome)]
    return [*lines, *(f"Doubt: {doubt}" for doubt in outcome.model.doubts)]


def _note(outcome: TuningResult, joint: int) -> str:
    if joint not in outcome.model.arm.joints_in_use:
        return f"{JOINT_NAMES[joint]}; not in use, as before"
    if not outcome.held_out:
        return JOINT_NAMES[joint]
    first = outcome.held_out[0]
    return f"{JOINT_NAMES[joint]}; on {first.name} {_change(first, joint)}"


def _change(one: HeldOut, joint: int | None = None) -> str:
    """The error before and after, and as a multiple of the floor, of one joint or all together."""
    before, after = one.mse_before, one.mse_after
    chosen = slice(None) if joint is None else slice(joint, joint + 1)
    text = f"MSE {before[chosen].sum():.3g} -> {after[chosen].sum():.3g} rad²"
    multiple = one.multiples[-1 if joint is None else joint]
    return text if multiple is None else f"{text}, {multiple:.2f} x the floor"


def _expected(one: HeldOut) -> dict[str, Any]:
    """A held-out motion, a value per joint: the measures that every joint has, before and after, and the floor."""
    facts: dict[str, Any] = {"motion": one.name}
    for when, evaluation in (("before", one.before), ("after", one.after)):
        columns: dict[str, Sequence[float | None]] = {
            f"mse_{when}_rad2": [joint.mse for joint in evaluation.joints],
            f"steady_state_error_{when}_rad": [joint.steady_state_error for joint in evaluation.joints],
            f"time_delay_{when}_s": [joint.delay_s for joint in evaluation.joints],
            f"onset_delay_{when}_s": [joint.onset_delay_s for joint in evaluation.joints],
            f"overshoot_{when}_percent": [joint.overshoot_percent for joint in evaluation.joints],
            f"settling_{when}_s": [joint.settling_s for joint in evaluation.joints],
        }
        for key, values in columns.items():
            known = [value for value in values if value is not None]
            if len(known) == len(values):
                facts[key] = _rounded(known)
    if one.floor is not None:
        facts["floor_mse_rad2"] = _rounded(one.floor.mse)
    return facts


def _margins(margins: tuple[Margin, ...]) -> list[dict[str, Any]]:
    """A row for each scenario, a value for each joint."""
    rows = []
    for scenario in dict.fromkeys(margin.scenario for margin in margins):
        joints = sorted((one for one in margins if one.scenario == scenario), key=lambda one: one.joint)
        rows.append(
            {
                "scenario": scenario,
                "holds": [one.holds for one in joints],
                "plants_failing": [one.plants_failing for one in joints],
                "reversals": [one.reversals for one in joints],
                "chatter_hz": _rounded(one.chatter_hz for one in joints),
                "rattle_rad": _rounded(one.rattle_rad for one in joints),
            }
        )
    return rows


def _rounded(values: Iterable[float]) -> list[float]:
    return [float(f"{value:.4g}") for value in values]
