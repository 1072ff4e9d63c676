"""The last part: why claims did or did not reproduce. Every number is this run's own."""

from __future__ import annotations

from typing import Any

import numpy as np

from greywhale.arm.printed import ERRATA
from greywhale_paper.pages import readings
from greywhale_paper.pages.document import Chapter, Entry, Row, Sheet, Status, words
from greywhale_paper.pages.found import Found
from greywhale_paper.pages.numbers import change, lower, one, percent, several
from greywhale_paper.pages.optimisers import SAID, function_ranks
from greywhale_paper.pages.tuning import totals
from greywhale_paper.work.findings import STUCK_RAD_S
from greywhale_paper.work.motions import PERIOD_MS
from greywhale_paper.work.optimisers import METHODS, SETTINGS

WORSE_PLACES = 2
# Simulated angles are kept in single precision.
ROUNDED_RAD = 1e-6


def chapter(found: Found) -> Chapter:
    return Chapter(
        "Why",
        (
            Entry("", "The errata", Status.OURS, _errata(found)),
            Entry("", "Every reading: steps", Status.OURS, readings.steps(found)),
            Entry("", "Every reading: multi-steps", Status.OURS, readings.multi_steps(found)),
            Entry("", "The control period", Status.OURS, _periods(found)),
            Entry("", "The objective", Status.OURS, _objective(found)),
            Entry("", "The saturation floor", Status.OURS, _floor(found)),
            Entry("", "Friction", Status.OURS, readings.friction(found)),
            Entry("", "What motion can show of a motor", Status.OURS, _identifiability(found)),
            Entry("", "Centre bias", Status.OURS, _centre_bias(found)),
        ),
    )


def _place(ranks: dict[str, float], method: str) -> int:
    return 1 + sum(other < ranks[method] for other in ranks.values())


def _errata(found: Found) -> tuple[Any, ...]:
    rows = []
    for name, effect in found.errata().items():
        energy = effect["energy"]
        shown = "runs away" if energy is None else "none" if energy < 1e-6 else f"{energy:.2g} J"
        cells = [ERRATA.get(name, "the links' errata together" if name != "all" else "all together"), shown]
        for arm in ("white_box", "grey_box"):
            cells += [f"{effect[arm]['angle']:.2g} rad", change(100 * (effect[arm]["mse"] - 1), ".2f")]
        rows.append(Row(name, tuple(cells)))
    table = Sheet(
        ("", "printed", "energy", "white box: angle", "MSE", "grey box: angle", "MSE"),
        rows,
        notes=(
            "Each alone in otherwise corrected equations. Energy: the largest change in 5 s of a free arm without "
            "friction. Angle and MSE: the change of a multi-step under the controllers from before, 20 ms.",
        ),
    )
    links, motor = (found.errata()[name]["grey_box"]["mse"] for name in ("E1 to E8", "E14"))
    white = found.errata()["E1 to E8"]["white_box"]["mse"]
    return table, words(
        f"The errata of the links change the white box's error by {change(100 * (white - 1))}, but the grey box's by "
        f"{change(100 * (links - 1), '.3f')} only: its motors are so heavy that the links hardly count. Eq. 1 read "
        f"literally (E14) changes the grey box's error by {change(100 * (motor - 1), '.0f')}. So the authors must have "
        "simulated something else than what is printed."
    )


def _periods(found: Found) -> tuple[Any, ...]:
    rows = []
    for period, run in found["periods"].items():
        cells = []
        for motion in ("steps", "multi-steps"):
            before, after = totals(run, motion, "before"), totals(run, motion)
            cells += [f"{before:.4f}", f"{after:.4f}"]
        rows.append(Row(f"{period} ms", tuple(cells)))
    table = Sheet(
        ("period", "steps, before", "steps, Table 10", "multi-steps, before", "multi-steps, Table 10"),
        rows,
        notes=("Total MSE in rad², the paper's grey-box arm at 15 V; K_d is scaled with the period.",),
    )
    steps = {period: (totals(run, "steps", "before"), totals(run, "steps")) for period, run in found["periods"].items()}
    first, last = steps[min(steps, key=int)], steps[max(steps, key=int)]
    better = [f"{period} ms" for period, (before, after) in steps.items() if after < before]
    order = f"better than before at {', '.join(better)} only" if better else "worse than before at every period"
    order = "better than before at every period" if len(better) == len(steps) else order
    swing = max(found["white box"]["swing_table_10"])
    still = max(found["white box"]["swing_before"])
    return table, words(
        f"The paper prints no control period; {PERIOD_MS} ms is an assumption. From 1 ms to 50 ms the error on steps "
        f"changes from {first[0]:.4f} to {last[0]:.4f} rad² before tuning and from {first[1]:.4f} to {last[1]:.4f} "
        f"with Table 10, which is {order}. On the white box at {PERIOD_MS} ms Table 10 still swings by {swing:.2f} rad "
        f"a second before the end of the step, the controllers from before by {still:.3f} rad."
    )


def _objective(found: Found) -> tuple[Any, ...]:
    first = found.objective()[0]
    rows = []
    for name, label in (
        ("doing nothing", "doing nothing"),
        ("before", "before tuning"),
        ("table_8", "Table 8"),
        ("table_10", "Table 10"),
    ):
        cost = first["J"][name]
        share = 100 * first["share_of_effort"][name]
        rows.append(Row(label, (f"{cost['one-sided']:.1f}", f"{cost['two-sided']:.1f}", f"{share:.0f} %")))
    table = Sheet(
        ("controllers", "J, one step", "J, multi-steps to both sides", "of it effort"),
        rows,
        notes=("Summed over the joints of the paper's grey-box arm, 20 V.",),
    )
    ku = [value for run in found.objective() for value in run["ku"]]
    before, idle = first["J"]["before"]["two-sided"], first["J"]["doing nothing"]["two-sided"]
    return table, words(
        f"On moves to both sides J is {100 * first['share_of_effort']['before']:.0f} % effort, and that of doing "
        f"nothing at all is {percent(before, idle)} than that of the controllers from before. A search for the scaling "
        f"factors on such moves turns K_u down to {several(ku, '.3f')} V of 20. Training on a single step hides this."
    )


def _floor(found: Found) -> tuple[Any, ...]:
    rows = []
    for motion in ("steps", "multi-steps"):
        before = totals(found["grey box printed"]["mf"], motion, "before")
        after = totals(found["grey box printed"]["mf"], motion)
        floor = sum(found["floors"][f"mf {motion}"]["mse"])
        bound = sum(found["floors"][f"mf {motion}"]["bound"])
        rows.append(Row(motion, (one(before), one(after), one(floor), one(bound), f"{lower(before, floor):.1f} %")))
    table = Sheet(
        ("total MSE [rad²]", "before tuning", "Table 10", "floor", "bound", "most that tuning could gain"),
        rows,
        notes=(
            "The paper's grey-box arm at 15 V. Floor: an ideal causal controller that knows everything. Bound: no "
            "controller that waits for the leader gets below it.",
        ),
    )
    before = totals(found["grey box printed"]["mf"], "steps", "before")
    most = lower(before, sum(found["floors"]["mf steps"]["mse"]))
    return table, words(
        "The voltage limits how fast the arm can be. In this reading (feet at 0, ce a difference, no friction) "
        f"tuning can lower the error on steps by {most:.1f} % at most. Other readings leave more, because more is "
        "wrong before tuning: see above."
    )


def _identifiability(found: Found) -> tuple[Any, ...]:
    facts = found["identifiability"]
    points = np.array([run["point"] for run in found.problem("identify")["gwo-woa"]])
    rows = []
    if len(points) > 1:
        joints = points.reshape(len(points), 4, 5)
        inertia, resistance, constant, viscous, ratio = np.moveaxis(joints, 2, 0)
        known = {
            "J": inertia,
            "Ra": resistance,
            "Kt": constant,
            "Bm": viscous,
            "r": ratio,
            "R/Kt": resistance / constant,
            "R J r/Kt": resistance * inertia * ratio / constant,
            "Kt r + Bm R/Kt": constant * ratio + viscous * resistance / constant,
        }
        for name, values in known.items():
            factors = values.max(axis=0) / values.min(axis=0)
            rows.append(Row(name, tuple(f"{factor:.3g}" for factor in factors)))
    table = Sheet(
        ("highest over lowest, all seeds", *(f"joint {joint}" for joint in range(4))),
        rows,
        notes=(
            "GWO-WOA with the paper's budget on data set 1; the last three are the combinations that motion shows.",
        ),
    )
    factors = ", ".join(f"{name} x {factor:g}" for name, factor in facts["factors"].items() if factor != 1.0)
    said = words(
        f"Eq. 1 depends on the {facts['values']} motor values by {facts['rank']} combinations only. Motors with other "
        f"values ({factors.replace('_', ' ')}) but the same combinations move the arm on data set 1 as the white box, "
        f"to {max(facts['angle'], ROUNDED_RAD):.1g} rad: no log can tell them apart. The {facts['rank']} combinations "
        f"themselves are seen with a condition number of the Fisher information of {facts['condition']:.2g}.",
        f"Of joints drawn uniformly from [0, 100] {100 * facts['stuck']:.0f} % do not even reach {STUCK_RAD_S:g} rad/s "
        "under the whole supply: nearly all of a first pack are stuck arms.",
    )
    return (table, said) if rows else (said,)


def _centre_bias(found: Found) -> tuple[Any, ...]:
    ranks = {setting: function_ranks(found, setting) for setting in SETTINGS}
    rows = [
        Row(
            SAID[method],
            (
                *(f"{ranks[setting][method]:.2f}" for setting in SETTINGS),
                *(str(_place(ranks[setting], method)) for setting in SETTINGS),
            ),
        )
        for method in METHODS
    ]
    table = Sheet(("method", "rank, plain", "rank, shifted", "place, plain", "place, shifted"), rows)
    fallen = [
        SAID[method]
        for method in METHODS
        if _place(ranks["shifted"], method) - _place(ranks["plain"], method) >= WORSE_PLACES
    ]
    return table, words(
        "Standard functions have their minimum at the origin, the middle of their box, where GWO and WOA settle by "
        f"themselves. Once the minimum lies elsewhere these fall by {WORSE_PLACES} places or more: "
        f"{', '.join(fallen) or 'none'}. A comparison on plain functions measures this bias."
    )
