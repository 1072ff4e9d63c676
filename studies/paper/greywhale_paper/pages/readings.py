"""The paper's printed controllers in every reading of the paper, on its own grey box; and where its 78 % comes from."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

import numpy as np

from greywhale.tune.report.tables import PAPER_STEADY_STATE, PAPER_STEP_MSE
from greywhale_paper.pages.document import Row, Sheet, words
from greywhale_paper.pages.found import Found
from greywhale_paper.pages.numbers import change, lower, one
from greywhale_paper.pages.printed import STEPS_LOWER
from greywhale_paper.work import errata
from greywhale_paper.work.findings import FRICTION_V
from greywhale_paper.work.readings import LENGTHS_S, SMALL_STEP_S, Reading

BEFORE, AFTER = "before_tuning", "table_10"


def gain(found: Found, reading: Reading, length: float) -> float:
    """By how many per cent Table 10 lowers the error on a step."""
    place = LENGTHS_S.index(length)
    return lower(*(found[reading.key][table]["steps"][place] for table in (BEFORE, AFTER)))


def multi_step_gain(found: Found, reading: Reading) -> float:
    """By how many per cent Table 10 lowers the error on multi-steps."""
    return lower(*(found[reading.key][table]["multi-steps"] for table in (BEFORE, AFTER)))


def most(found: Found, reading: Reading, length: float) -> float:
    """By how many per cent any controller could lower it."""
    floor = found["reading floors"][reading.friction]["steps"] / length
    return lower(found[reading.key][BEFORE]["steps"][LENGTHS_S.index(length)], floor)


def steps(found: Found) -> tuple[Any, ...]:
    """Steps: Table 10's gain by the length of the record, and the most that is possible."""
    rows: list[Row] = []
    for reading in found.request.readings:
        rows += _heading(rows, reading)
        first = [found[reading.key][table]["steps"][0] for table in (BEFORE, AFTER)]
        cells = [f"{gain(found, reading, length):.0f} of {most(found, reading, length):.0f}" for length in LENGTHS_S]
        small = [found[reading.key][table]["small step"] for table in (BEFORE, AFTER)]
        rows.append(Row(reading.law, (*(f"{mse:.3f}" for mse in first), *cells, f"{lower(*small):.0f}")))
    table = Sheet(
        (
            "reading",
            f"before, {LENGTHS_S[0]:g} s",
            "Table 10",
            *(f"{length:g} s" for length in LENGTHS_S),
            f"0.5 rad, {SMALL_STEP_S:g} s",
        ),
        rows,
        notes=(
            "Total MSE in rad² of a step of 1 rad on the paper's grey box at 15 V, over so many seconds from the "
            "step on; then by how many per cent Table 10 lowers it, of how many per cent that the best possible "
            "controller could (the floor). A negative number is an increase. Sensors are exact.",
        ),
    )
    gains = [gain(found, reading, length) for reading in found.request.readings for length in LENGTHS_S]
    possible = {
        reading.law
        for reading in found.request.readings
        for length in LENGTHS_S
        if most(found, reading, length) >= STEPS_LOWER
    }
    reached = [
        f"{reading.law}, {reading.friction}, {reading.period_ms} ms, {length:g} s"
        for reading in found.request.readings
        for length in LENGTHS_S
        if gain(found, reading, length) >= STEPS_LOWER
    ]
    where = f"in: {'; '.join(reached)}" if reached else "in none of them"
    return table, words(
        f"So Table 10 changes the error on a step by {-max(gains):+.0f} to {-min(gains):+.0f} %, and how much it is "
        f"depends on what the paper leaves open. {STEPS_LOWER:g} % is within reach of a controller in "
        f"{len(possible)} of the 4 ways to read sets and change of error; Table 10 itself gains as much "
        f"{where}. The longer the record, the more an error at rest counts.",
    )


def _heading(rows: Sequence[Row], reading: Reading) -> list[Row]:
    said = f"{reading.friction}, {reading.period_ms} ms"
    return [] if any(row.label == said for row in rows) else [Row(said)]


def multi_steps(found: Found) -> tuple[Any, ...]:
    """Multi-steps likewise."""
    rows: list[Row] = []
    seconds = len(errata.LEVELS) * errata.HOLD_S
    gains = []
    for reading in found.request.readings:
        rows += _heading(rows, reading)
        before, after = (found[reading.key][table]["multi-steps"] for table in (BEFORE, AFTER))
        floor = found["reading floors"][reading.friction]["multi-steps"] / seconds
        gains.append(multi_step_gain(found, reading))
        rows.append(
            Row(
                reading.law,
                (
                    f"{before:.3f}",
                    f"{after:.3f}",
                    f"{floor:.3f}",
                    change(-gains[-1], ".0f"),
                    change(-lower(before, floor), ".0f"),
                ),
            )
        )
    table = Sheet(
        ("reading", "before", "Table 10", "floor", "Table 10 changes it by", "the floor by"),
        rows,
        notes=(f"Total MSE in rad² over {seconds:g} s of multi-steps, otherwise as above.",),
    )
    shares = ", ".join(f"{100 * share:.0f}" for share in found["silent"][AFTER])
    return table, words(
        "The same reading that is best for the paper on steps need not be on multi-steps: there Table 10 changes "
        f"the error by {-max(gains):+.0f} to {-min(gains):+.0f} %. With crisp feet it leaves {shares} % of the "
        "joints' planes without any rule, where the controller does nothing.",
    )


def friction(found: Found) -> tuple[Any, ...]:
    """Steady-state errors with and without friction, beside Table 11's."""
    studies = found["friction"]
    rows = [Row("steady-state error, rad")]
    for joint in range(4):
        cells = [one(side[joint], ".2f") for side in PAPER_STEADY_STATE]
        for study in studies.values():
            cells += [one(study[table]["steady"][0][joint], ".3f") for table in (BEFORE, AFTER)]
        rows.append(Row(f"joint {joint}", tuple(cells)))
    rows.append(Row("total MSE of a step, rad²"))
    for place, length in enumerate(LENGTHS_S):
        theirs = [one(side[4]) for side in PAPER_STEP_MSE] if place == 0 else ["", ""]
        cells = [f"{study[table]['mse'][place]:.3f}" for study in studies.values() for table in (BEFORE, AFTER)]
        rows.append(Row(f"over {length:g} s", (*theirs, *cells)))
    names = [_volts(volts) for volts in FRICTION_V]
    table = Sheet(
        (
            "",
            "before, printed",
            "after, printed",
            *(word for name in names for word in (f"before, {name}", f"Table 10, {name}")),
        ),
        rows,
        (1, 2),
        (
            "The paper's grey box under the firmware's integer controllers, 20 ms, 15 V; feet at 0, ce a difference. "
            "The paper prints no length of its records.",
        ),
    )
    gains = {
        name: [
            [lower(study[BEFORE]["mse"][place], study[other]["mse"][place]) for place in range(len(LENGTHS_S))]
            for other in ("table_8", AFTER)
        ]
        for name, study in zip(names, studies.values(), strict=True)
    }
    said = [
        f"with {name} Table 8 lowers the error by {_percents(eight)} %, Table 10 by {_percents(ten)} %"
        for name, (eight, ten) in gains.items()
    ]
    before, plain = (float(np.max(list(studies.values())[place][BEFORE]["steady"][0])) for place in (2, 0))
    return table, words(
        f"The paper neglects friction and reports steady-state errors of up to {max(PAPER_STEADY_STATE[0]):g} rad. "
        f"Its own model without friction rests within {plain:.3f} rad; with the friction that these errors imply it "
        f"rests {before:.3f} rad off. For records of {_percents(LENGTHS_S)} s: {'; '.join(said)}.",
        *_method(found),
    )


def _method(found: Found) -> tuple[str, ...]:
    """What the method finds on its model without friction, on the arm with it."""
    worse = {
        motion: [
            lower(sum(run["sticky"][motion]["before"]["mse"]), sum(run["sticky"][motion]["after"]["mse"]))
            for run in found.grey_box("mf")
        ]
        for motion in ("steps", "multi-steps")
    }
    return (
        "The paper's method itself, which tunes on the model without friction, changes the error of the arm with "
        f"friction by {-max(worse['steps']):+.0f} to {-min(worse['steps']):+.0f} % on steps and by "
        f"{-max(worse['multi-steps']):+.0f} to {-min(worse['multi-steps']):+.0f} % on multi-steps, {found.seeds}: "
        "its printed Table 10 is better against friction than what its method finds.",
    )


def _volts(volts: Sequence[float]) -> str:
    if not any(volts):
        return "no friction"
    return f"{volts[0]:g} V of friction" if len(set(volts)) == 1 else "friction of Table 11"


def _percents(values: Sequence[float]) -> str:
    return ", ".join(f"{value:.0f}" for value in values)


def where_it_comes_from() -> Any:
    """Table 11's error taken apart into what is left at rest and the rest of it."""
    left = [sum(error**2 for error in side) for side in PAPER_STEADY_STATE]
    moving = [side[4] - rest for side, rest in zip(PAPER_STEP_MSE, left, strict=True)]
    odd = PAPER_STEADY_STATE[0][1] ** 2
    return words(
        "The squares of Table 11's own steady-state errors add up to "
        f"{left[0]:.3f} rad² before tuning, {100 * left[0] / PAPER_STEP_MSE[0][4]:.0f} % of its mean squared error "
        f"of {PAPER_STEP_MSE[0][4]:g}, and to {left[1]:.4f} rad² after. What is left for the moves is "
        f"{moving[0]:.3f} rad² before and {moving[1]:.3f} rad² after. So the whole gain is error at rest that went "
        "away, which friction causes and the paper's model does not have; the moves did not get better. (Joint 1 "
        f"alone would rest at {PAPER_STEADY_STATE[0][1]:g} rad, whose square, {odd:.3f} rad², exceeds its own mean "
        f"squared error of {PAPER_STEP_MSE[0][1]:g}: the two cannot come from one held step.)",
    )
