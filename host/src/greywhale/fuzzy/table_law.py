"""A law of two inputs and one output as a table of rules, in fractions, from a .fis; and why a .fis is none.

Triangles and trapezoids, AND is min, aggregation is max, the output is the centroid of the area: of clipped sets (min),
or of scaled ones (prod) that lie apart from each other.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from fractions import Fraction

from greywhale.base.errors import UserError
from greywhale.files.fis import AND, Fis, Set, Variable
from greywhale.fuzzy.limits import HEADER_LIMITS, HeaderLimits

NO_RULE = -1
CORNERS = {"trimf": 3, "trapmf": 4}
# What a law may say, its default in MATLAB first.
METHODS = {
    "andmethod": ("min",),
    "impmethod": ("min", "prod"),
    "aggmethod": ("max",),
    "defuzzmethod": ("centroid",),
}
# What a double's last bits do to a corner, of a range: no crossing and no overlap.
NOISE = Fraction(1, 10**9)
Corners = tuple[Fraction, Fraction, Fraction, Fraction]


@dataclass(frozen=True)
class Axis:
    """A variable's range and its sets' names and corners (a <= b <= c <= d), in the variable's own unit."""

    name: str
    low: Fraction
    high: Fraction
    names: tuple[str, ...]
    sets: tuple[Corners, ...]

    def scaled(self) -> tuple[Corners, ...]:
        """The corners with -1 and 1 at the ends of the range."""
        middle, half = (self.low + self.high) / 2, (self.high - self.low) / 2
        return tuple(_corners([(corner - middle) / half for corner in one]) for one in self.sets)


@dataclass(frozen=True)
class TableLaw:
    """table[i][j] is the output's set, from 0, where the inputs' sets are i and j, or NO_RULE.

    The output's sets are in the order in which they lie on its axis; `clipped` where a rule clips its set (min) and
    does not scale it (prod).
    """

    name: str
    source: str  # the file, for sentences
    inputs: tuple[Axis, Axis]
    output: Axis
    table: tuple[tuple[int, ...], ...]
    clipped: bool


def obstacles(fis: Fis, limits: HeaderLimits = HEADER_LIMITS) -> list[str]:
    """Reasons why a file is no such law, each with its line; nothing where it is one."""
    return [
        *_counts(fis),
        *_methods(fis),
        *(words for variable in (*fis.inputs, *fis.outputs) for words in _sets(variable, limits)),
        *(words for rule in fis.rules for words in _rule(rule.ifs, rule.thens, rule.weight, rule.link, rule.line)),
    ]


def from_fis(fis: Fis, path: str, limits: HeaderLimits = HEADER_LIMITS) -> TableLaw:
    """The law in a file; UserError with the first reason why there is none."""
    for words in obstacles(fis, limits):
        raise UserError(f"{path}: {words}.")
    clipped = fis.method("impmethod", "min")[0] == "min"
    given = fis.outputs[0]
    order = sorted(range(len(given.sets)), key=lambda k: given.sets[k].numbers)
    output = _axis(given, order)
    for words in _apart(output, clipped):
        raise UserError(f"{path}: line {given.line}: {words}.")
    first, second = (_axis(variable, range(len(variable.sets))) for variable in fis.inputs)
    table = [[NO_RULE] * len(second.sets) for _ in first.sets]
    for rule in fis.rules:
        i, j = (int(term) - 1 for term in rule.ifs)
        then = order.index(int(rule.thens[0]) - 1)
        if table[i][j] not in (NO_RULE, then):
            where = f"{first.names[i]} and {second.names[j]}"
            raise UserError(f"{path}: line {rule.line}: a second rule for {where}, and it says something else.")
        table[i][j] = then
    return TableLaw(fis.name, path, (first, second), output, tuple(map(tuple, table)), clipped)


def _counts(fis: Fis) -> Iterator[str]:
    kind, line = fis.method("type", "mamdani")
    if kind != "mamdani":
        yield f"line {line}: its type is {kind!r}; only a Mamdani system has a table of sets"
    for variables, wanted, words in ((fis.inputs, 2, "inputs"), (fis.outputs, 1, "output")):
        if len(variables) != wanted:
            yield f"line {variables[0].line}: {len(variables)} {words.rstrip('s')}s; a table has {wanted} {words}"


def _methods(fis: Fis) -> Iterator[str]:
    for key, allowed in METHODS.items():
        value, line = fis.method(key, allowed[0])
        if value not in allowed:
            yield f"line {line}: {key} is {value!r}; it must be {' or '.join(allowed)}"


def _sets(variable: Variable, limits: HeaderLimits) -> Iterator[str]:
    if not 1 <= len(variable.sets) <= limits.most_sets:
        yield (
            f"line {variable.line}: {variable.name!r} has {len(variable.sets)} sets; it must have 1 to"
            f" {limits.most_sets}"
        )
    for one in variable.sets:
        if one.kind not in CORNERS:
            yield f"line {one.line}: {one.name!r} is a {one.kind}; only trimf and trapmf are made of straight lines"
        elif len(one.numbers) != CORNERS[one.kind] or list(one.numbers) != sorted(one.numbers):
            yield f"line {one.line}: {one.name!r} needs {CORNERS[one.kind]} corners, none below the one before"
        elif one.numbers[0] == one.numbers[-1]:
            yield f"line {one.line}: {one.name!r} is a single point"
        elif one.numbers[0] >= variable.high or one.numbers[-1] <= variable.low:
            yield f"line {one.line}: {one.name!r} lies outside the range of {variable.name!r}"


def _rule(ifs: Sequence[float], thens: Sequence[float], weight: float, link: int, line: int) -> Iterator[str]:
    terms = (*ifs, *thens)
    if weight != 1:
        yield f"line {line}: the rule's weight is {weight:g}; it must be 1"
    if link != AND and sum(term != 0 for term in ifs) > 1:
        yield f"line {line}: the rule says `or`; in a table every rule says `and`"
    if any(term < 0 for term in terms):
        yield f"line {line}: the rule says `not`; name the sets that are meant"
    if any(term == 0 for term in terms):
        yield f"line {line}: the rule leaves a variable out; name its sets one by one"
    if any(term != int(term) for term in terms):
        yield f"line {line}: the rule has a hedge (a set's number with a fraction); a table has none"


def _axis(variable: Variable, order: Sequence[int]) -> Axis:
    sets = [variable.sets[k] for k in order]
    names = tuple(one.name for one in sets)
    return Axis(
        variable.name, Fraction(variable.low), Fraction(variable.high), names, tuple(_trapezoid(one) for one in sets)
    )


def _trapezoid(one: Set) -> Corners:
    corners = [Fraction(number) for number in one.numbers]
    return _corners(corners if len(corners) == CORNERS["trapmf"] else [*corners[:2], *corners[1:]])


def _corners(values: Sequence[Fraction]) -> Corners:
    a, b, c, d = values
    return a, b, c, d


def _apart(output: Axis, clipped: bool) -> Iterator[str]:
    """Reasons why the area under the output's sets is no sum of their areas, less what neighbours share."""
    noise = NOISE * (output.high - output.low)
    for (a, b, c, d), name in zip(output.sets, output.names, strict=True):
        if a + noise < output.low < b - noise or c + noise < output.high < d - noise:
            yield f"a flank of {name!r} crosses the end of the range; end it there, or draw it wholly outside"
    for k, (one, after) in enumerate(zip(output.sets, output.sets[1:], strict=False)):
        names = f"{output.names[k]!r} and {output.names[k + 1]!r}"
        if any(right < left - noise for left, right in zip(one, after, strict=True)):
            yield f"of {names} neither lies right of the other"
        if not clipped and one[3] > after[0] + noise:
            yield f"{names} overlap; with ImpMethod='prod' the output's sets must lie apart"
        if k + 2 < len(output.sets) and one[3] > output.sets[k + 2][0] + noise:
            yield f"{output.names[k]!r} and {output.names[k + 2]!r} overlap, with a set between them"
