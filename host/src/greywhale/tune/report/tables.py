"""A tuning in the layouts of the paper's Tables 8 to 12, as text and as data, with the paper's figures if asked.

Controllers come raw as a board stores them, int32 (4, 13), and are shown as it will use them. Beside the paper's
columns stand the improvement and, where a `Floor` is known, the error as a multiple of the least possible.
"""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from dataclasses import dataclass, replace
from typing import TYPE_CHECKING, Annotated, TypedDict

import numpy as np
import numpy.typing as npt

from greywhale.base import telling
from greywhale.base.telling import Part
from greywhale.base.types import Controllers
from greywhale.files.controller import load
from greywhale.files.paper_tables import paper_table
from greywhale.fuzzy.settings import GAIN_UNIT, SET_UNIT
from greywhale.loop import CONTROLLER_COLUMNS, controller_row
from greywhale.measure import Evaluation, more_overshoot
from greywhale.protocol.firmware import JOINTS
from greywhale.protocol.joints import ALL, Joints

if TYPE_CHECKING:
    from greywhale.tune.result import TuningResult

Numbers = Sequence[float | None]

_LABELS = (*(f"Joint {joint}" for joint in ALL), "All joints")
_SUM = JOINTS  # the place of all joints' sum behind theirs

# The paper's names in its order, with our columns and how many raw steps make up 1.
FACTORS = {"K_p": ("kp", GAIN_UNIT), "K_d": ("kd", GAIN_UNIT), "K_i": ("ki", GAIN_UNIT), "K_u": ("ku_mv", 1000)}
_CORNERS = ("Ne_trapmf_c", "Ze_trimf_a", "Ze_trimf_c", "Pe_trapmf_b")
_CHANGE_CORNERS = ("Nce_trapmf_c", "Zce_trimf_a", "Zce_trimf_c", "Pce_trapmf_b")
SETS = {
    name: (name.replace("_trapmf", "").replace("_trimf", "").lower(), SET_UNIT) for name in _CORNERS + _CHANGE_CORNERS
}
_FACTOR_UNITS = "K_p in 1/rad, K_d in 1/rad over 20 ms, K_i in V/(rad s), K_u in V."
_NO_WIDTH = "The paper prints joint 0's Ze_trimf_c as 0, a set without width; 0.01, the least, stands here."
_OTHER_ARM = "paper: measured on its authors' arm, led by hand; what is out of reach there is not known."

# Tables 11 and 12 of Obadina et al. 2022: before, after.
PAPER_STEP_MSE = ((0.0324, 0.0808, 0.0235, 0.0492, 0.1858), (0.0034, 0.0106, 0.0180, 0.0086, 0.0405))
PAPER_STEADY_STATE = ((0.14, 0.31, 0.15, 0.12), (0.02, 0.01, 0.03, 0.01))
PAPER_DELAY = ((0.20, 0.25, 0.25, 0.30), (0.10, 0.10, 0.15, 0.10))
PAPER_MULTI_STEP_MSE = ((0.1021, 0.1040, 0.0384, 0.2974, 0.5420), (0.0250, 0.0974, 0.2364, 0.0772, 0.4360))
# Heading, name in JointMeasures, form, and the paper's figures.
_Measure = tuple[str, str, str, tuple[Numbers, Numbers] | None]
_STEPS: tuple[_Measure, ...] = (
    ("Overshoot of steps (%)", "overshoot_percent", ".1f", None),
    ("Settling time of steps (s)", "settling_s", ".3f", None),
)
_MEASURES: tuple[_Measure, ...] = (
    ("Steady-state error (rad)", "steady_state_error", ".3f", PAPER_STEADY_STATE),
    ("Time delay, onset (s)", "onset_delay_s", ".3f", PAPER_DELAY),
    ("Time delay, correlation (s)", "delay_s", ".3f", None),
    *_STEPS,
)
_SETTLING = "settling time: to within 5 % of the step (at least 0.02 rad); -: one never settled."


# A value, or null, for each column, and names of the row and of the heading above it.
_NAME = {"type": "string"}
Row = Annotated[
    dict[str, str | float | None], ("properties", {"group": _NAME, "row": _NAME}), ("required", ["group", "row"])
]


class TableFacts(TypedDict):
    title: str
    columns: list[str]  # keys of each row
    rows: list[Row]
    remarks: list[str]


@dataclass(frozen=True)
class Group:
    """Rows under one heading; `form` is how numbers are shown where the column has no form of its own."""

    heading: str
    rows: tuple[tuple[str, tuple[float | None, ...]], ...]
    form: str


@dataclass(frozen=True)
class Table:
    """Columns with the form of their numbers ("": the group's), groups of rows, and remarks below."""

    title: str
    columns: tuple[tuple[str, str], ...]
    groups: tuple[Group, ...]
    remarks: tuple[str, ...] = ()

    def as_dict(self) -> TableFacts:
        """For JSON: a row an object, numbers as they are, None where there is none."""
        names = [name for name, _ in self.columns]
        rows: list[Row] = [
            {"group": group.heading, "row": label, **dict(zip(names, values, strict=True))}
            for group in self.groups
            for label, values in group.rows
        ]
        return {"title": self.title, "columns": names, "rows": rows, "remarks": list(self.remarks)}

    def tell(self) -> list[Part]:
        """The table for people; a heading stands above its rows, remarks below all."""
        rows = []
        for group in self.groups:
            rows += [telling.Row((group.heading,))] if group.heading else []
            rows += [telling.Row((label, *self._cells(group, values))) for label, values in group.rows]
        columns = (telling.Column(left=True), *(telling.Column(name) for name, _ in self.columns))
        return [telling.Table(columns, rows, self.title), telling.Sentences(self.remarks, near=True)]

    def text(self) -> str:
        return telling.Telling(self.tell()).text()

    def _cells(self, group: Group, values: Iterable[float | None]) -> list[str]:
        forms = [form or group.form for _, form in self.columns]
        return ["-" if value is None else f"{value:{form}}" for value, form in zip(values, forms, strict=True)]


def scaling_factors(after: Controllers, *, joints: Joints = ALL, paper: bool = False) -> Table:
    """Table 8: the tuned scaling factors."""
    theirs = _paper("table_8") if paper else None
    return _parameters("Tuned scaling factors (layout of Table 8)", FACTORS, (), after, joints, theirs)


def factors_and_sets(after: Controllers, *, joints: Joints = ALL, paper: bool = False) -> Table:
    """Table 9: the tuned scaling factors and sets."""
    theirs = _paper("table_9") if paper else None
    title = "Tuned scaling factors and sets (layout of Table 9)"
    table = _parameters(title, FACTORS | SETS, (), after, joints, theirs)
    return replace(table, remarks=(*table.remarks, _NO_WIDTH)) if paper else table


def fuzzy_sets(before: Controllers, after: Controllers, *, joints: Joints = ALL, paper: bool = False) -> Table:
    """Table 10: the sets before (once, where all joints begin with the same) and after."""
    columns = [CONTROLLER_COLUMNS.index(column) for column, _ in SETS.values()]
    begun = before[list(joints)]
    same = bool((begun[:, columns] == begun[0, columns]).all())
    starts = [("before", begun[0])] if same else [(f"before {joint}", before[joint]) for joint in joints]
    theirs = _paper("table_10") if paper else None
    return _parameters("Tuned sets (layout of Table 10)", SETS, starts, after, joints, theirs)


def step_performance(
    before: Evaluation, after: Evaluation, multiples: Numbers | None = None, *, paper: bool = False
) -> Table:
    """Table 11: the three measures of a step response, with overshoot and settling time. `multiples` of the floor
    (4 joints, then all): Floor.multiple.

    The paper's time delay runs from the leader's to the follower's onset. Below it stands the lag of best correlation,
    which also shows slow rises.
    """
    title = "Step response before and after tuning (layout of Table 11)"
    return _performance(title, before, after, multiples, _MEASURES, PAPER_STEP_MSE if paper else None)


def motion_performance(
    name: str, before: Evaluation, after: Evaluation, multiples: Numbers | None = None, *, paper: bool = False
) -> Table:
    """Table 12: the errors of a motion, with overshoot and settling time; the paper's are of multi-steps."""
    title = f"Response to {name} before and after tuning (layout of Table 12)"
    return _performance(title, before, after, multiples, _STEPS, PAPER_MULTI_STEP_MSE if paper else None)


def _performance(
    title: str,
    before: Evaluation,
    after: Evaluation,
    multiples: Numbers | None,
    measures: Sequence[_Measure],
    errors: tuple[Numbers, Numbers] | None,
) -> Table:
    """The errors, `errors` being the paper's, then the measures; of the joints in use."""
    joints = before.joints_in_use
    floors = (None,) * (JOINTS + 1) if multiples is None else multiples
    was, now = _errors(before), _errors(after)
    groups = [_compared((*joints, _SUM), "Mean squared error (rad²)", "#.3g", was, now, floors, errors)]
    for heading, name, form, printed in measures:
        theirs = printed if errors is not None else None
        groups.append(
            _compared(joints, heading, form, _each(before, name), _each(after, name), (None,) * JOINTS, theirs)
        )
    more = more_overshoot(before, after)
    remarks = (_SETTLING, *((f"MORE OVERSHOOT than before: {more}.",) if more else ()))
    return _comparison(title, groups, remarks, errors is not None)


def _parameters(
    title: str,
    wanted: dict[str, tuple[str, int]],
    starts: Sequence[tuple[str, npt.NDArray[np.int32]]],
    after: Controllers,
    joints: Joints,
    theirs: Controllers | None,
) -> Table:
    """A row a parameter; a column for every start, every joint in use and, if asked, every joint of the paper."""
    columns = [*starts, *((_LABELS[joint], after[joint]) for joint in joints)]
    if theirs is not None:
        columns += [(f"paper {joint}", row) for joint, row in enumerate(theirs)]
    rows = []
    for label, (column, unit) in wanted.items():
        place = CONTROLLER_COLUMNS.index(column)
        rows.append((label, tuple(float(row[place]) / unit for _, row in columns)))
    remarks = (_FACTOR_UNITS,) if "K_p" in wanted else ()
    return Table(title, tuple((name, "") for name, _ in columns), (Group("", tuple(rows), ".4f"),), remarks)


def _paper(table: str) -> Controllers:
    return controller_row(load(paper_table(table)))


def _errors(evaluation: Evaluation) -> list[float]:
    return [*(joint.mse for joint in evaluation.joints), evaluation.total_mse]


def _each(evaluation: Evaluation, name: str) -> list[float | None]:
    return [getattr(joint, name) for joint in evaluation.joints]


def _compared(
    places: Sequence[int],
    heading: str,
    form: str,
    before: Numbers,
    after: Numbers,
    multiples: Numbers,
    theirs: tuple[Numbers, Numbers] | None,
) -> Group:
    rows = []
    for place in places:
        was, now = before[place], after[place]
        values: tuple[float | None, ...] = (was, now, _improvement(was, now), multiples[place])
        papers = (None, None) if theirs is None else (theirs[0][place], theirs[1][place])
        rows.append((_LABELS[place], values + papers))
    return Group(heading, tuple(rows), form)


def _comparison(title: str, groups: Sequence[Group], notes: tuple[str, ...], paper: bool) -> Table:
    columns = (("before", ""), ("after", ""), ("lower by %", ".1f"), ("x floor", ".2f"))
    theirs = (("paper before", ""), ("paper after", ""))
    floors = any(values[3] is not None for group in groups for _, values in group.rows)
    floor = ("x floor: after tuning as a multiple of the least that any controller could reach.",) if floors else ()
    remarks = (*floor, *notes)
    if paper:
        return Table(title, columns + theirs, tuple(groups), (*remarks, _OTHER_ARM))
    plain = (Group(one.heading, tuple((label, values[:4]) for label, values in one.rows), one.form) for one in groups)
    return Table(title, columns, tuple(plain), remarks)


def _improvement(before: float | None, after: float | None) -> float | None:
    """By how many per cent the error fell; negative where it rose."""
    if before is None or after is None or before == 0.0:
        return None
    return 100.0 * (1.0 - after / before)


def tables_of(outcome: TuningResult, *, paper: bool = False) -> tuple[Table, ...]:
    """The tables that a tuning fills: 8, 9 or 10 by its strategy, 11 for steps, 12 for every other held-out motion."""
    joints = outcome.model.arm.joints_in_use
    parameters = {
        "sf": lambda: scaling_factors(outcome.after, joints=joints, paper=paper),
        "both": lambda: factors_and_sets(outcome.after, joints=joints, paper=paper),
        "mf": lambda: fuzzy_sets(outcome.before, outcome.after, joints=joints, paper=paper),
    }
    tables = [parameters[outcome.strategy]()]
    for one in outcome.held_out:
        if one.name == "steps":
            tables.append(step_performance(one.before, one.after, one.multiples, paper=paper))
        else:
            known = paper and one.name == "multi-steps"
            tables.append(motion_performance(one.name, one.before, one.after, one.multiples, paper=known))
    return tuple(tables)
