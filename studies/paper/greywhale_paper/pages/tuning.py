"""Sections 4 and 5.2: the paper's three ways to tune, on the paper's grey-box arm in simulation."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import Any

import numpy as np

from greywhale.base.types import Controllers
from greywhale.files.controller import load
from greywhale.files.paper_tables import paper_table
from greywhale.loop import CONTROLLER_COLUMNS
from greywhale.pictures import looks
from greywhale.pictures.identification import Trace
from greywhale.protocol.firmware import JOINTS
from greywhale.protocol.joints import named
from greywhale.tune.paper import AGENTS, ITERATIONS, LARGEST_SUPPLY_V
from greywhale.tune.report.tables import FACTORS, SETS
from greywhale_paper.pages.document import Chapter, Entry, Picture, Row, Sheet, Status, words
from greywhale_paper.pages.found import Found, controllers
from greywhale_paper.pages.numbers import lower, one, several
from greywhale_paper.pages.printed import FIG_19_FLAT, NO_WIDTH, TABLE_7
from greywhale_paper.pictures import curves
from greywhale_paper.work.grey_box import STRATEGIES, supply_of
from greywhale_paper.work.motions import PERIOD_MS, printed

NAMES = {"sf": "scaling factors", "both": "scaling factors and sets", "mf": "sets"}
FIGURES = {"sf": "Fig. 14", "both": "Fig. 15", "mf": "Fig. 17"}
# K_u counts as at its bound from this share of it on.
AT_BOUND = 0.99
ASIDE = "in simulation, on the paper's grey-box arm of Table 4"


def chapter(found: Found) -> Chapter:
    """Tables 7 to 10, Figs. 14 to 17 and 19."""
    return Chapter(
        "Sections 4 and 5.2: tuning in simulation",
        (
            Entry("Table 7", "GWO-WOA parameters for tuning the sets", Status.COMPUTED, (_table_7(),)),
            Entry("Table 8", "Tuned scaling factors", Status.COMPUTED, _values(found, "sf", FACTORS)),
            _figure(found, "sf"),
            Entry(
                "Table 9",
                "Tuned scaling factors and input sets",
                Status.COMPUTED,
                _values(found, "both", FACTORS | SETS),
            ),
            _figure(found, "both"),
            Entry("Table 10", "Tuned input sets", Status.COMPUTED, _values(found, "mf", SETS)),
            Entry("Fig. 16", "Input membership functions after tuning", Status.COMPUTED, _figure_16(found)),
            _figure(found, "mf"),
            Entry("Fig. 19", "Convergence curves", Status.COMPUTED, _figure_19(found)),
            Entry("", "Which of the three is best", Status.COMPUTED, _which(found)),
        ),
    )


def _table_7() -> Sheet:
    used = {
        "Number of search agents": str(AGENTS),
        "Maximum iteration": str(ITERATIONS),
        "Number of variables": "8 for each joint",
        "Objective function": "ITAE + ITAU",
        "Lower bounds": "as printed; widths below 0.01 become 0.01",
        "Upper bounds": "as printed; widths below 0.01 become 0.01",
    }
    rows = [Row(name, (TABLE_7[name], used[name])) for name in TABLE_7]
    return Sheet(("parameter", "printed", "used here"), rows, (1,))


def value_of(rows: Controllers, joint: int, column: str, unit: int) -> float:
    """A number of a joint as the paper prints it."""
    return float(rows[joint, CONTROLLER_COLUMNS.index(column)]) / unit


def _values(found: Found, strategy: str, wanted: Mapping[str, tuple[str, int]]) -> tuple[Any, ...]:
    """The paper's layout: a row a parameter, a column a joint; ours beside it."""
    results = found.grey_box(strategy)
    runs = [controllers(run) for run in results]
    before = printed("before_tuning") if strategy == "mf" else None
    note = f"{found.seeds[0].upper()}{found.seeds[1:]}, {ASIDE}, {PERIOD_MS} ms, {supply_of(strategy):g} V."
    units = f"K_p in 1/rad, K_d in 1/rad over {PERIOD_MS} ms, K_i in V/(rad s), K_u in V."
    notes = [note, units] if "K_p" in wanted else [note]
    if strategy == "both":
        notes.append("Joint 0's printed Ze_trimf_c is 0, a set without width; where it is tried it is 0.01, the least.")
    blocks: list[Any] = [_beside(wanted, STRATEGIES[strategy], runs, before, notes)]
    if strategy == "both":
        own = [controllers(run["tuned"]) for run in found.default()]
        note = f"greywhale's own tuning, by its own objective, for the model that it identified: {found.few_seeds}."
        note += _untouched(own)
        rows = [
            Row(name, tuple(several([value_of(run, joint, *where) for run in own]) for joint in range(JOINTS)))
            for name, where in wanted.items()
        ]
        blocks.append(Sheet(("", *(f"Joint {joint}" for joint in range(JOINTS))), rows, notes=(note,)))
    return (*blocks, *_spread(results, runs, wanted))


def _untouched(runs: Sequence[Controllers]) -> str:
    """A sentence on joints for which a run found nothing better than what they had."""
    before = printed("before_tuning")
    kept = tuple(joint for joint in range(JOINTS) if any((run[joint] == before[joint]).all() for run in runs))
    return f" Nothing better than before tuning was found in at least one run: {named(kept)}." if kept else ""


def quoted(table: str, joint: int, column: str) -> float:
    """A number as a table of the paper prints it, before it is rounded to what a board stores."""
    known = load(paper_table(table)).joint[joint]
    values = {name.lower(): value for name, value in (known.model_dump() | known.sets.model_dump()).items()}
    key = column.removesuffix("_mv")
    return float(NO_WIDTH.get((table, joint, key), values[key]))


def _beside(
    wanted: Mapping[str, tuple[str, int]],
    theirs: str,
    runs: Sequence[Controllers],
    before: Controllers | None,
    notes: Sequence[str],
) -> Sheet:
    start = ("",) if before is None else ("", "before")
    pairs = [word for joint in range(JOINTS) for word in (f"J{joint}, printed", f"J{joint}, here")]
    rows = []
    for name, where in wanted.items():
        cells = [] if before is None else [one(value_of(before, 0, *where))]
        for joint in range(JOINTS):
            cells += [
                one(quoted(theirs, joint, where[0])),
                several([value_of(run, joint, *where) for run in runs], ".3f"),
            ]
        rows.append(Row(name, tuple(cells)))
    first = len(start)
    printed_columns = [*range(1, first), *range(first, first + 2 * JOINTS, 2)]
    return Sheet((*start, *pairs), rows, printed_columns, notes)


def _spread(
    results: Sequence[Any], runs: Sequence[Controllers], wanted: Mapping[str, tuple[str, int]]
) -> tuple[Any, ...]:
    """How far the seeds are apart in what they found, and in what it costs."""
    said = []
    if "K_u" in wanted:
        found = np.array([[value_of(run, joint, *wanted["K_u"]) for joint in range(JOINTS)] for run in runs])
        at_bound = int((found >= AT_BOUND * LARGEST_SUPPLY_V).sum())
        said.append(f"K_u ends at its bound of {LARGEST_SUPPLY_V:g} V in {at_bound} of {found.size} searches.")
    corners = [wanted[name] for name in wanted if name in SETS]
    if len(runs) > 1 and corners:
        values = np.array(
            [[[value_of(run, joint, *where) for where in corners] for joint in range(JOINTS)] for run in runs]
        )
        apart = np.ptp(values, axis=0)
        costs = np.array([run["cost"] for run in results])
        cheap = 100.0 * (np.ptp(costs, axis=0) / costs.min(axis=0))
        said.append(
            f"The corners are searched over a width of 1. From seed to seed they differ by {np.median(apart):.2f} in "
            f"the median and by {apart.max():.2f} at most, while a joint's J differs by {np.median(cheap):.1f} % in "
            f"the median and by {cheap.max():.0f} % at most. One printed run says little about the values."
        )
    return (words(*said),) if said else ()


def _figure(found: Found, strategy: str) -> Entry:
    ours = found.grey_box(strategy)[0]["motions"]["multi-steps"]["trace"]
    theirs = found["grey box printed"][strategy]["multi-steps"]["trace"]
    leader = Trace("leader", ours["time"], ours["leader"], looks.LEADER)
    table = STRATEGIES[strategy].replace("_", " ").capitalize()
    traces = [
        Trace("before tuning", ours["time"], ours["before"], looks.BEFORE),
        Trace("paper's method, first seed", ours["time"], ours["after"], looks.PAPERS_METHOD),
        Trace(f"{table} as printed", theirs["time"], theirs["after"], looks.PRINTED),
    ]
    return Entry(
        FIGURES[strategy],
        f"Simulated multi-step response using tuned {NAMES[strategy]}",
        Status.COMPUTED,
        (
            Picture(
                curves.responses(
                    [leader, *traces], leader, f"Multi-steps, tuned {NAMES[strategy]}", "leader less follower"
                ),
                f"The paper's grey-box arm at {PERIOD_MS} ms and {supply_of(strategy):g} V. The leader's levels are "
                "ours: the paper's are in its figures alone.",
            ),
        ),
    )


def _figure_16(found: Found) -> tuple[Any, ...]:
    after = {
        "Table 10": printed("table_10"),
        "paper's method, first seed": controllers(found.grey_box("mf")[0]),
    }
    return (
        Picture(
            curves.sets_after(printed("before_tuning"), after), "The printed sets, and those that the search found."
        ),
    )


def _figure_19(found: Found) -> tuple[Any, ...]:
    runs = [run["curves"] for run in found.grey_box("mf")]
    picture = curves.convergence_of_joints(runs, "Tuning the sets by the paper's method", AGENTS)
    flat = [[last_improvement_of_joint(run[joint]) for run in runs] for joint in range(JOINTS)]
    rows = [Row(f"Joint {joint}", (str(FIG_19_FLAT[joint]), several(flat[joint], ".0f"))) for joint in range(JOINTS)]
    return (
        Picture(picture, "Best J so far; one line a seed."),
        Sheet(("last improvement", "printed", f"here, {found.seeds}"), rows, (1,)),
    )


def last_improvement_of_joint(curve: Mapping[str, Sequence[float]]) -> int:
    """The iteration that brought the last improvement."""
    cost = np.array(curve["cost"])
    return round(curve["evaluations"][int(np.argmax(cost <= cost[-1]))] / AGENTS) - 1


def totals(run: Mapping[str, Any], motion: str, which: str = "after") -> float:
    """The MSE of all joints of a judged motion."""
    return float(sum(run[motion][which]["mse"]))


def _which(found: Found) -> tuple[Any, ...]:
    rows = []
    best: dict[str, float] = {}
    for strategy, name in NAMES.items():
        runs, theirs = [run["motions"] for run in found.grey_box(strategy)], found["grey box printed"][strategy]
        rows.append(Row(f"{name}, {supply_of(strategy):g} V"))
        for motion in ("steps", "multi-steps"):
            before = totals(theirs, motion, "before")
            ours = [totals(run, motion) for run in runs]
            floor = sum(found["floors"][f"{'mf' if strategy == 'mf' else 'sf'} {motion}"]["mse"])
            rows.append(
                Row(
                    motion,
                    (
                        one(before, ".3f"),
                        one(totals(theirs, motion), ".3f"),
                        several(ours, ".3f"),
                        several([lower(before, value) for value in ours], ".1f"),
                        one(floor, ".3f"),
                    ),
                )
            )
            best.setdefault(f"{strategy} {motion}", float(np.median([lower(before, value) for value in ours])))
    order = sorted(NAMES, key=lambda strategy: -best[f"{strategy} multi-steps"])
    table = Sheet(
        ("total MSE [rad²]", "before", "printed controllers", "paper's method", "lower by %", "floor"),
        rows,
        notes=(f"Paper's method: {found.seeds}, {ASIDE}. Floor: no controller whatever gets lower at that supply.",),
    )
    return table, words(
        "The paper finds that tuning the sets alone gives the best multi-step responses. Here the order by how much "
        f"the error falls is: {', '.join(NAMES[strategy] for strategy in order)}. "
        "The scaling factors have the advantage of 20 V, where the sets alone have 15 V."
    )
