"""The distance of a header's integers from the exact law: a bound over all inputs, the largest found; and holes.

A hole, the weakest answer and the error of every height are found over all places of both axes, which is every input:
a table joins the axes by their few patterns of active sets. The bound follows from them; docs/library.md derives it.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from itertools import product

import numpy as np

from greywhale.base.errors import UserError
from greywhale.base.types import Floats
from greywhale.fuzzy import table_twin as twin
from greywhale.fuzzy.area import Shape, centroid, shapes
from greywhale.fuzzy.limits import HEADER_LIMITS, HeaderLimits
from greywhale.fuzzy.table_law import NO_RULE, Axis, TableLaw
from greywhale.fuzzy.table_twin import END, FULL, IntegerLaw, Ints

PLACES = np.arange(-END, END + 1)
BEST, ROUNDS, NEAR = 16, 24, 256  # of the search from the worst places on
# Errors of a shape's area and moment, in units: two and three roundings of coefficients, each product one.
AREA_ERROR, MOMENT_ERROR = 3.0, 4.5
TOP_ERROR = (
    4 / FULL**2
)  # of both, where a shared shape ends: its width is 4 / FULL there at most, and the step 1 / FULL


@dataclass(frozen=True)
class Proof:
    """Differences in LSB (1/16384 of half the output's range); `at` is where the largest was found, q14."""

    least_height: float
    bound: float
    largest: float
    at: tuple[int, int]
    searched: int


def prove(law: TableLaw, numbers: IntegerLaw, limits: HeaderLimits = HEADER_LIMITS) -> Proof:
    """UserError where there is a hole: an input for which no rule fires, or almost none."""
    members = [twin.memberships(sets, PLACES) for sets in numbers.inputs]
    least = _least_height(law, members, limits)
    exact = [twin.axis_heights(axis.scaled(), PLACES / END) for axis in law.inputs]
    bound = _bound(law, members, exact, least)
    largest, at, searched = _search(law, numbers)
    return Proof(least / FULL, bound, largest, at, searched)


def require_no_hole(law: TableLaw, limits: HeaderLimits = HEADER_LIMITS) -> None:
    """The part of `prove` that refuses."""
    _least_height(law, [twin.memberships(sets, PLACES) for sets in twin.of_law(law).inputs], limits)


def exact_u(law: TableLaw, e: Ints, ce: Ints) -> Floats:
    """The exact centroid for places e and ce, in LSB, but for a double's bits."""
    of_e, of_ce = (twin.axis_heights(axis.scaled(), x / END) for axis, x in zip(law.inputs, (e, ce), strict=True))
    found = np.zeros((len(law.output.sets), len(e)))
    for i, row in enumerate(law.table):
        for j, then in enumerate(row):
            if then != NO_RULE:
                np.maximum(found[then], np.minimum(of_e[i], of_ce[j]), out=found[then])
    return centroid(law, list(found)) * END


def _patterns(active: np.ndarray) -> tuple[Ints, Ints]:
    """The sets that are active together, as bits, and the first place of each pattern."""
    bits = (active.astype(np.int64) << np.arange(len(active))[:, None]).sum(axis=0)
    patterns, first = np.unique(bits, return_index=True)
    return patterns, first


def _fired(law: TableLaw, of_e: int, of_ce: int) -> set[int]:
    return {
        then
        for i, row in enumerate(law.table)
        for j, then in enumerate(row)
        if then != NO_RULE and of_e >> i & 1 and of_ce >> j & 1
    }


def _hole(law: TableLaw, members: list[Ints], height: int) -> tuple[int, int] | None:
    """A place where no rule reaches this height."""
    (of_e, at_e), (of_ce, at_ce) = (_patterns(member >= height) for member in members)
    for (i, one), (j, other) in product(enumerate(of_e.tolist()), enumerate(of_ce.tolist())):
        if not _fired(law, one, other):
            return int(PLACES[at_e[i]]), int(PLACES[at_ce[j]])
    return None


def _least_height(law: TableLaw, members: list[Ints], limits: HeaderLimits) -> int:
    """The height that the strongest rule has at least, wherever the inputs are."""
    if (place := _hole(law, members, 1 + int(limits.least_height * FULL))) is not None:
        where = " and ".join(f"{axis.name} = {real(axis, at):.4g}" for axis, at in zip(law.inputs, place, strict=True))
        raise UserError(
            f"{law.source}: the rules have a hole: at {where} no rule fires above {limits.least_height:.4f};"
            " add a rule, or widen a set."
        )
    least, beyond = 1, FULL + 1
    while beyond - least > 1:
        middle = (least + beyond) // 2
        least, beyond = (middle, beyond) if _hole(law, members, middle) is None else (least, middle)
    return least


def real(axis: Axis, place: int) -> float:
    """A place in the variable's own unit."""
    return float((axis.low + axis.high) / 2 + (axis.high - axis.low) / 2 * place / END)


def _bound(law: TableLaw, members: list[Ints], exact: list[Floats], least: int) -> float:
    error = max(float(np.abs(m / FULL - x).max()) for m, x in zip(members, exact, strict=True)) + 1e-12
    (of_e, _), (of_ce, _) = (_patterns((m > 0) | (x > 0)) for m, x in zip(members, exact, strict=True))
    own, _ = shapes(law)
    ends = [(max(-1.0, float(a)), min(1.0, float(d))) for a, _, _, d in law.output.scaled()]
    weakest = np.array([least / FULL])
    worst = 0.0
    for fired in {frozenset(_fired(law, *pair)) for pair in product(of_e.tolist(), of_ce.tolist())}:
        terms = 2 * len(fired) - 1
        area = min(float(own[k].area_below(weakest)[0]) for k in fired) - terms * (
            AREA_ERROR / twin.AREA_UNIT + TOP_ERROR
        )
        from_heights = error * _lever(law, own, ends, fired)
        from_sums = terms * ((AREA_ERROR + MOMENT_ERROR) / twin.AREA_UNIT + TOP_ERROR)
        worst = max(worst, (from_heights + from_sums) / area)
    return worst * END + 0.5


def _lever(law: TableLaw, own: tuple[Shape, ...], ends: list[tuple[float, float]], fired: frozenset[int]) -> float:
    """The most that an error of 1 in every height moves the moment about the centroid, wherever that lies."""
    if law.clipped:
        width = max(ends[k][1] for k in fired) - min(ends[k][0] for k in fired)
        return width * width / 2
    full = np.array([(float(own[k].area[0]), float(own[k].moment[0])) for k in fired])
    centres = full[:, 1] / full[:, 0]
    return max(float(np.abs(full[:, 1] - u * full[:, 0]).sum()) for u in (centres.min(), centres.max()))


def _grid(axis: Axis, member: Ints) -> Ints:
    """Places where the law bends, their neighbours, and even ones between."""
    corners = [round(float(corner) * END) for one in axis.scaled() for corner in one]
    crossings = np.flatnonzero(np.diff(member.argmax(axis=0))) - END
    bends = np.array([*corners, *crossings.tolist(), 0])
    near = (bends[:, None] + np.arange(-2, 3)).ravel()
    return np.unique(np.clip(np.concatenate([near, np.linspace(-END, END, 401).round().astype(int)]), -END, END))


def _search(law: TableLaw, numbers: IntegerLaw) -> tuple[float, tuple[int, int], int]:
    """The largest difference on a grid, and near its worst places; the same for the same law."""

    def differences(e: Ints, ce: Ints) -> Floats:
        return np.asarray(np.abs(twin.u(numbers, e, ce) - exact_u(law, e, ce)))

    axes = [_grid(axis, twin.memberships(s, PLACES)) for axis, s in zip(law.inputs, numbers.inputs, strict=True)]
    e, ce = (one.ravel() for one in np.meshgrid(*axes, indexing="ij"))
    found = differences(e, ce)
    worst = np.argsort(found)[-BEST:]
    return _climb(differences, np.array([e[worst], ce[worst]]), found[worst], len(e))


def _climb(
    differences: Callable[[Ints, Ints], Floats], places: Ints, found: Floats, searched: int
) -> tuple[float, tuple[int, int], int]:
    random = np.random.default_rng(0)
    for step in range(ROUNDS):
        reach = max(1, END >> (2 + step * 10 // ROUNDS))
        moved = places[:, :, None] + random.integers(-reach, reach + 1, (2, BEST, NEAR))
        moved = np.clip(moved, -END, END)
        value = differences(moved[0].ravel(), moved[1].ravel()).reshape(BEST, NEAR)
        searched += value.size
        best = value.argmax(axis=1)
        rows = np.arange(BEST)
        better = value[rows, best] > found
        places = np.where(better, moved[:, rows, best], places)
        found = np.maximum(found, value[rows, best])
    top = int(found.argmax())
    return float(found[top]), (int(places[0, top]), int(places[1, top])), searched
