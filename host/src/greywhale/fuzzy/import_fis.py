"""Reads a .fis back into a joint's sets, bit for bit where greywhale wrote it; and why a firmware cannot run another.

The firmware has one law: a file is that law if it says what `export_fis` would write for its own corners.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping

from greywhale.base.errors import UserError
from greywhale.files.controller import NARROWEST_FLANK
from greywhale.files.fis import Fis, Rule, Variable, parse
from greywhale.fuzzy.export_fis import fis_text

METHODS = ("type", "andmethod", "ormethod", "impmethod", "aggmethod", "defuzzmethod")
# Where each corner stands: input, set, and place in its numbers.
PLACES = {
    "ne_c": (0, 0, 2),
    "ze_a": (0, 1, 0),
    "ze_c": (0, 1, 2),
    "pe_b": (0, 2, 1),
    "nce_c": (1, 0, 2),
    "zce_a": (1, 1, 0),
    "zce_c": (1, 1, 2),
    "pce_b": (1, 2, 1),
}
LEFT = {"ne_c", "ze_a", "nce_c", "zce_a"}


def sets_of(fis: Fis, path: str) -> dict[str, float]:
    """The corners by the names that `fis_text` takes; UserError with the first reason why a firmware cannot run it."""
    for words in firmware_obstacles(fis):
        raise UserError(f"{path}: {words}; the firmware cannot run this.")
    return {name: _corner(fis, name) for name in PLACES}


def firmware_obstacles(fis: Fis) -> list[str]:
    """All that differs from the law of the firmware, each with its line; nothing for a file that greywhale wrote."""
    ours = parse(fis_text("", {name: _corner(fis, name) for name in PLACES}))
    return [
        *_methods(fis, ours),
        *_variables(fis.inputs, ours.inputs, "inputs"),
        *_variables(fis.outputs, ours.outputs, "output"),
        *_rules(fis, ours),
    ]


def _corner(fis: Fis, name: str) -> float:
    """A corner where the file has one that a board takes, else one that a board takes."""
    place, order, index = PLACES[name]
    side = -1 if name in LEFT else 1
    try:
        corner = fis.inputs[place].sets[order].numbers[index]
    except IndexError:
        return side * NARROWEST_FLANK
    return corner if NARROWEST_FLANK <= side * corner <= 1 else side * NARROWEST_FLANK


def _methods(fis: Fis, ours: Fis) -> Iterator[str]:
    for key in METHODS:
        value, line = fis.method(key, ours.method(key, "")[0])
        if value != (wanted := ours.method(key, "")[0]):
            yield f"line {line}: {key} is {value!r}, not {wanted!r}"


def _variables(found: tuple[Variable, ...], ours: tuple[Variable, ...], words: str) -> Iterator[str]:
    if len(found) != len(ours):
        yield f"line {found[0].line}: {len(found)} {words.rstrip('s')}s, not {len(ours)}"
    for one, wanted in zip(found, ours, strict=False):
        if (one.low, one.high) != (wanted.low, wanted.high):
            yield (
                f"line {one.line}: {one.name!r} goes from {one.low:g} to {one.high:g},"
                f" not {wanted.low:g} to {wanted.high:g}"
            )
        if len(one.sets) != len(wanted.sets):
            yield f"line {one.line}: {one.name!r} has {len(one.sets)} sets, not {len(wanted.sets)}"
            continue
        for each, its in zip(one.sets, wanted.sets, strict=True):
            if (each.kind, each.numbers) != (its.kind, its.numbers):
                shown = " ".join(f"{number:g}" for number in each.numbers)
                meant = " ".join(f"{number:g}" for number in its.numbers)
                yield f"line {each.line}: {each.name!r} is {each.kind} [{shown}], not {its.kind} [{meant}]"


def _rules(fis: Fis, ours: Fis) -> Iterator[str]:
    def sizes(one: Fis) -> list[int]:
        return [len(variable.sets) for variable in (*one.inputs, *one.outputs)]

    if sizes(fis) != sizes(ours):
        return

    def by_ifs(rules: tuple[Rule, ...]) -> Mapping[tuple[float, ...], Rule]:
        return {rule.ifs: rule for rule in rules}

    wanted, found = by_ifs(ours.rules), by_ifs(fis.rules)
    for rule in fis.rules:
        its = wanted.get(rule.ifs)
        if its is None or (rule.thens, rule.weight, rule.link) != (its.thens, its.weight, its.link):
            yield f"line {rule.line}: this rule is not in the paper's table"
    for ifs in sorted(wanted.keys() - found.keys()):
        yield f"line 1: the rule for the sets {ifs[0]:g} and {ifs[1]:g} is missing"
