"""Sections 5.3 and 5.4: steps and multi-steps on the bench, before and after tuning."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import Any

from greywhale.pictures import looks
from greywhale.pictures.identification import Trace
from greywhale.protocol.firmware import JOINTS
from greywhale.tune.report.tables import PAPER_DELAY, PAPER_MULTI_STEP_MSE, PAPER_STEADY_STATE, PAPER_STEP_MSE
from greywhale_paper.pages.document import Chapter, Entry, Picture, Row, Sheet, Status, words
from greywhale_paper.pages.found import Found
from greywhale_paper.pages.numbers import lower, one, several
from greywhale_paper.pages.printed import MULTI_STEPS_LOWER, STEPS_LOWER
from greywhale_paper.pages.tuning import totals
from greywhale_paper.pictures import curves
from greywhale_paper.tasks import OWN_PERIOD_MS
from greywhale_paper.work.arms import DEFAULT, STICKY
from greywhale_paper.work.motions import PERIOD_MS

# A joint that swings by more than this after a step does not rest, rad.
RESTLESS_RAD = 0.03
ERROR = "leader less follower"
LOOKS = (looks.BEFORE, looks.PAPERS_METHOD, looks.AFTER)
# Heading of Table 11, our name, the paper's numbers, and their form.
MEASURES: tuple[tuple[str, str, tuple[Sequence[float], Sequence[float]] | None, str], ...] = (
    ("Steady-state error (rad)", "steady", PAPER_STEADY_STATE, ".3f"),
    ("Settling error (rad): the end of the move is in it; not in the paper", "settling", None, ".3f"),
    ("Time delay (s), from onset to onset", "onset", PAPER_DELAY, ".3f"),
    ("Time delay (s), of best correlation; not in the paper", "delay", None, ".3f"),
    ("Swing in the last second (rad, from end to end); not in the paper", "swing", None, ".3f"),
)


def chapter(found: Found) -> Chapter:
    """Figs. 18 and 20, Tables 11 and 12."""
    return Chapter(
        "Sections 5.3 and 5.4: experiments on the bench",
        (
            Entry("Fig. 18", "Step responses before and after optimisation", Status.MEASURED, _figure(found, "steps")),
            Entry("Table 11", "Performance before and after tuning", Status.MEASURED, _table_11(found)),
            Entry("Fig. 20", "Multi-step responses", Status.MEASURED, _figure(found, "multi-steps")),
            Entry("Table 12", "MSE of the multi-step response", Status.MEASURED, _table_12(found)),
            Entry("", "Tables 11 and 12 on an arm like the paper's", Status.MEASURED, _sticky(found)),
            Entry("", "The same controllers on their models", Status.COMPUTED, (_simulated(found),)),
        ),
    )


def _figure(found: Found, motion: str) -> tuple[Any, ...]:
    runs = {
        "before tuning": found.untuned("before_tuning", PERIOD_MS),
        "paper's method": found.paper()[0]["measured"],
        "greywhale": found.default()[0]["measured"],
    }
    traces = [
        Trace(
            name,
            [t - run[motion]["trace"]["time"][0] for t in run[motion]["trace"]["time"]],
            run[motion]["trace"]["after"],
            look,
        )
        for (name, run), look in zip(runs.items(), LOOKS, strict=True)
    ]
    first = runs["before tuning"][motion]["trace"]
    leader = Trace("leader", traces[0].time, first["leader"], looks.LEADER)
    title = f"{motion.capitalize()} on the bench, first seed"
    shown = [
        Picture(
            curves.responses([leader, *traces], leader, title, ERROR),
            f"From the board's own samples. Before tuning and the paper's method at {PERIOD_MS} ms, greywhale at "
            f"{OWN_PERIOD_MS} ms.",
        )
    ]
    if motion == "steps":
        shown.append(
            Picture(
                curves.responses([leader, *traces], leader, "The same steps close up", ERROR, window=(1.3, 2.7)),
                "What happens around the leader's move.",
            )
        )
    return tuple(shown)


def columns_of(found: Found, arm: str = DEFAULT) -> dict[str, list[Any]]:
    """Our columns for an arm: name -> runs on the bench."""
    paper = found.paper(arm)
    columns = {
        f"before, {PERIOD_MS} ms": [found.untuned("before_tuning", PERIOD_MS, arm)],
        "paper's method": [run["measured"] for run in paper],
        "Table 10": [found.untuned("table_10", PERIOD_MS, arm)],
        f"before, {OWN_PERIOD_MS} ms": [found.untuned("before_tuning", OWN_PERIOD_MS, arm)],
        f"paper's method, {OWN_PERIOD_MS} ms": [run["measured, own period"] for run in paper],
        f"Table 10, {OWN_PERIOD_MS} ms": [found.untuned("table_10", OWN_PERIOD_MS, arm)],
    }
    return columns | ({"greywhale": [run["measured"] for run in found.default()]} if arm == DEFAULT else {})


Columns = Mapping[str, Sequence[Any]]


def _numbers(columns: Columns, motion: str, measure: str) -> list[list[Sequence[float | None]]]:
    """For each of our columns the runs, each four numbers."""
    return [[run[motion]["after"][measure] for run in runs] for runs in columns.values()]


def _mse_rows(columns: Columns, motion: str, theirs: tuple[Sequence[float], Sequence[float]]) -> list[Row]:
    rows = []
    for joint in range(JOINTS + 1):
        label = f"Joint {joint}" if joint < JOINTS else "All joints"
        cells = [one(side[joint]) for side in theirs]
        for runs in _numbers(columns, motion, "mse"):
            cells.append(several([_joint_or_all(run, joint) for run in runs], ".4f"))
        rows.append(Row(label, tuple(cells)))
    return rows


def _joint_or_all(run: Sequence[float | None], joint: int) -> float:
    known = [value or 0.0 for value in run]
    return sum(known) if joint == JOINTS else known[joint]


def _rows_11(columns: Columns) -> list[Row]:
    rows = [Row("Mean squared error (rad²)"), *_mse_rows(columns, "steps", PAPER_STEP_MSE)]
    for heading, measure, theirs, form in MEASURES:
        rows.append(Row(heading))
        for joint in range(JOINTS):
            cells = ["–", "–"] if theirs is None else [one(side[joint], ".2f") for side in theirs]
            cells += [several([run[joint] for run in runs], form) for runs in _numbers(columns, "steps", measure)]
            rows.append(Row(f"Joint {joint}", tuple(cells)))
    return rows


def _table_11(found: Found) -> tuple[Any, ...]:
    columns = columns_of(found)
    rows = _rows_11(columns)
    return _sheet(found, columns, rows), _summary(found, "steps", STEPS_LOWER), _hunting(columns)


def _sticky(found: Found) -> tuple[Any, ...]:
    columns = columns_of(found, STICKY)
    rows = [*_rows_11(columns), Row("Mean squared error of the multi-steps (rad²)")]
    rows += _mse_rows(columns, "multi-steps", PAPER_MULTI_STEP_MSE)
    return (
        words(
            "The bench with the paper's grey box and the friction that Table 11's errors before tuning imply "
            "(docs/arm.md). Model and controllers come from its own logs, by the paper's method: its model has no "
            "friction."
        ),
        _sheet(found, columns, rows),
        _summary(found, "steps", STEPS_LOWER, STICKY),
        _summary(found, "multi-steps", MULTI_STEPS_LOWER, STICKY),
    )


def _hunting(columns: Columns) -> Any:
    """How many joints never come to rest after the step."""
    hunting = []
    for name, runs in zip(columns, _numbers(columns, "steps", "swing"), strict=True):
        swings = [swing or 0.0 for run in runs for swing in run]
        hunting.append(f"{name} {sum(swing > RESTLESS_RAD for swing in swings)} of {len(swings)}")
    return words(
        f"Joints that still swing by more than {RESTLESS_RAD:g} rad in the last second of the step, over all seeds: "
        f"{'; '.join(hunting)}. A joint that hunts costs more than the paper's measures show."
    )


def _table_12(found: Found) -> tuple[Any, ...]:
    columns = columns_of(found)
    rows = _mse_rows(columns, "multi-steps", PAPER_MULTI_STEP_MSE)
    worse = PAPER_MULTI_STEP_MSE[1][2] / PAPER_MULTI_STEP_MSE[0][2]
    return (
        _sheet(found, columns, rows),
        _summary(found, "multi-steps", MULTI_STEPS_LOWER),
        words(f"In the paper's own table joint 2 is {worse:.1f} times worse after tuning; the total hides it."),
    )


def _sheet(found: Found, columns: Columns, rows: list[Row]) -> Sheet:
    ends = {run[motion]["stopped"] for runs in columns.values() for run in runs for motion in ("steps", "multi-steps")}
    notes = [
        f"Paper's method: {found.seeds}, each with its own identification. greywhale: {found.few_seeds}.",
        "The supervisor's checks of motion were off, so that each experiment is seen to its end.",
    ]
    notes += [f"A recording ended early: {reason}" for reason in sorted(ends - {""})]
    return Sheet(("", "before, printed", "after, printed", *columns), rows, (1, 2), notes)


def changes(found: Found, motion: str, arm: str = DEFAULT) -> dict[str, list[float]]:
    """By how many per cent the total MSE on the bench fell, for each of our columns that is no start of another."""
    columns = columns_of(found, arm)
    fell = {}
    for name, runs in columns.items():
        own = name == "greywhale" or name.endswith(f", {OWN_PERIOD_MS} ms")
        (start,) = columns[f"before, {OWN_PERIOD_MS if own else PERIOD_MS} ms"]
        if not name.startswith("before"):
            fell[name] = [lower(totals(start, motion), totals(run, motion)) for run in runs]
    return fell


def _summary(found: Found, motion: str, theirs: float, arm: str = DEFAULT) -> Any:
    fell = [f"{name} {several(gains, '.1f')} %" for name, gains in changes(found, motion, arm).items()]
    return words(
        f"The paper reports a total on {motion} that is {theirs:g} % lower after tuning. Here it is lower by, each "
        f"against before tuning at its own period: {'; '.join(fell)}. A negative number is an increase."
    )


def _simulated(found: Found) -> Sheet:
    rows = []
    for motion in ("steps", "multi-steps"):
        rows.append(Row(motion))
        for name, runs in (("paper's method", found.paper()), ("greywhale", found.default())):
            model = [totals(run["simulated"], motion) for run in runs]
            bench = [totals(run["measured"], motion) for run in runs]
            ratio = [a / b for a, b in zip(model, bench, strict=True)]
            rows.append(Row(name, (several(model), several(bench), several(ratio, ".2f"))))
    return Sheet(
        ("total MSE [rad²]", "on the identified model", "on the bench", "model / bench"),
        rows,
        notes=("A ratio far from 1 says that the model does not predict what its controllers do on the arm.",),
    )
