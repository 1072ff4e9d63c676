"""Sections 5.3 and 5.4: steps and multi-steps on the bench, before and after tuning."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

from greywhale.pictures import looks
from greywhale.pictures import paper_curves as curves
from greywhale.pictures.paper_curves import Trace
from greywhale.protocol.firmware import JOINTS
from greywhale.reproduce.pages.document import Chapter, Entry, Picture, Row, Sheet, Status, sheet, words
from greywhale.reproduce.pages.found import Found
from greywhale.reproduce.pages.numbers import lower, one, several
from greywhale.reproduce.pages.printed import MULTI_STEPS_LOWER, STEPS_LOWER
from greywhale.reproduce.pages.tuning import totals
from greywhale.reproduce.tasks import OWN_PERIOD_MS
from greywhale.reproduce.work.motions import PERIOD_MS
from greywhale.tune.report.tables import PAPER_DELAY, PAPER_MULTI_STEP_MSE, PAPER_STEADY_STATE, PAPER_STEP_MSE

# A joint that swings by more than this after a step does not rest, rad.
RESTLESS_RAD = 0.03
ERROR = "leader less follower"
LOOKS = (looks.BEFORE, looks.PAPERS_METHOD, looks.AFTER)
COLUMNS = (
    "before, printed",
    "after, printed",
    f"before, {PERIOD_MS} ms",
    "paper's method",
    "paper's Table 10",
    f"before, {OWN_PERIOD_MS} ms",
    "greywhale",
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
            Entry("", "The same controllers on their models", Status.COMPUTED, (_simulated(found),)),
        ),
    )


def _figure(found: Found, motion: str) -> tuple[Any, ...]:
    runs = {
        "before tuning": found[f"bench before_tuning {PERIOD_MS}"],
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


def _reference(found: Found, name: str, period: int) -> Any:
    return found[f"bench {name} {period}"]


def _columns(found: Found, motion: str, measure: str) -> list[list[Sequence[float | None]]]:
    """For each of our columns the runs, each four numbers."""
    single = [
        [_reference(found, "before_tuning", PERIOD_MS)],
        [run["measured"] for run in found.paper()],
        [_reference(found, "table_10", PERIOD_MS)],
        [_reference(found, "before_tuning", OWN_PERIOD_MS)],
        [run["measured"] for run in found.default()],
    ]
    return [[run[motion]["after"][measure] for run in runs] for runs in single]


def _mse_rows(found: Found, motion: str, theirs: tuple[Sequence[float], Sequence[float]]) -> list[Row]:
    columns = _columns(found, motion, "mse")
    rows = []
    for joint in range(JOINTS + 1):
        label = f"Joint {joint}" if joint < JOINTS else "All joints"
        cells = [one(side[joint]) for side in theirs]
        for runs in columns:
            cells.append(several([_joint_or_all(run, joint) for run in runs], ".4f"))
        rows.append(Row(label, tuple(cells)))
    return rows


def _joint_or_all(run: Sequence[float | None], joint: int) -> float:
    known = [value or 0.0 for value in run]
    return sum(known) if joint == JOINTS else known[joint]


def _table_11(found: Found) -> tuple[Any, ...]:
    rows = [Row("Mean squared error (rad²)"), *_mse_rows(found, "steps", PAPER_STEP_MSE)]
    for heading, measure, theirs, form in (
        ("Steady-state error (rad)", "steady", PAPER_STEADY_STATE, ".3f"),
        ("Settling error (rad): the end of the move is in it; not in the paper", "settling", None, ".3f"),
        ("Time delay (s), from onset to onset", "onset", PAPER_DELAY, ".3f"),
        ("Time delay (s), of best correlation; not in the paper", "delay", None, ".3f"),
        ("Swing in the last second (rad, from end to end); not in the paper", "swing", None, ".3f"),
    ):
        rows.append(Row(heading))
        columns = _columns(found, "steps", measure)
        for joint in range(JOINTS):
            cells = ["–", "–"] if theirs is None else [one(side[joint], ".2f") for side in theirs]
            cells += [several([run[joint] for run in runs], form) for runs in columns]
            rows.append(Row(f"Joint {joint}", tuple(cells)))
    return _sheet(found, rows), _summary(found, "steps", STEPS_LOWER), _hunting(found)


def _hunting(found: Found) -> Any:
    """How many joints never come to rest after the step."""
    hunting = []
    for runs in _columns(found, "steps", "swing"):
        swings = [swing or 0.0 for run in runs for swing in run]
        hunting.append(f"{sum(swing > RESTLESS_RAD for swing in swings)} of {len(swings)}")
    before, paper, table_10, own, ours = hunting
    return words(
        f"Joints that still swing by more than {RESTLESS_RAD:g} rad in the last second of the step, over all seeds: "
        f"before tuning {before} ({PERIOD_MS} ms) and {own} ({OWN_PERIOD_MS} ms), paper's method {paper}, Table 10 "
        f"{table_10}, greywhale {ours}. A joint that hunts costs more than the paper's measures show."
    )


def _table_12(found: Found) -> tuple[Any, ...]:
    rows = _mse_rows(found, "multi-steps", PAPER_MULTI_STEP_MSE)
    worse = PAPER_MULTI_STEP_MSE[1][2] / PAPER_MULTI_STEP_MSE[0][2]
    return (
        _sheet(found, rows),
        _summary(found, "multi-steps", MULTI_STEPS_LOWER),
        words(f"In the paper's own table joint 2 is {worse:.1f} times worse after tuning; the total hides it."),
    )


def _sheet(found: Found, rows: list[Row]) -> Sheet:
    stopped = sorted(
        {
            run[motion]["stopped"]
            for run in (*[one["measured"] for one in found.paper()], *[one["measured"] for one in found.default()])
            for motion in ("steps", "multi-steps")
            if run[motion]["stopped"]
        }
    )
    notes = [
        f"Paper's method: {found.seeds}, each with its own identification. greywhale: {found.few_seeds}.",
        "The supervisor's checks of motion were off, so that each experiment is seen to its end.",
    ]
    notes += [f"A recording ended early: {reason}" for reason in stopped]
    return sheet(("", *COLUMNS), rows, (1, 2), notes)


def changes(found: Found, motion: str) -> dict[str, list[float]]:
    """By how many per cent the total MSE on the bench fell: paper's method, Table 10, greywhale."""
    before = _total(_reference(found, "before_tuning", PERIOD_MS), motion)
    own = _total(_reference(found, "before_tuning", OWN_PERIOD_MS), motion)
    return {
        "paper": [lower(before, _total(run["measured"], motion)) for run in found.paper()],
        "table 10": [lower(before, _total(_reference(found, "table_10", PERIOD_MS), motion))],
        "greywhale": [lower(own, _total(run["measured"], motion)) for run in found.default()],
    }


def _total(run: Any, motion: str) -> float:
    return totals(run, motion)


def _summary(found: Found, motion: str, theirs: float) -> Any:
    fell = changes(found, motion)
    return words(
        f"The paper reports a total that is {theirs:g} % lower after tuning. On the bench the paper's method lowers it "
        f"by {several(fell['paper'], '.1f')} %, the paper's printed Table 10 by {several(fell['table 10'], '.1f')} %, "
        f"greywhale by {several(fell['greywhale'], '.1f')} %. A negative number is an increase."
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
    return sheet(
        ("total MSE [rad²]", "on the identified model", "on the bench", "model / bench"),
        rows,
        notes=("A ratio far from 1 says that the model does not predict what its controllers do on the arm.",),
    )
