"""No bare number stands where a limit belongs: each of a room that judges is a limit, or has its reason beside it."""

from __future__ import annotations

import ast
from collections.abc import Iterator
from itertools import takewhile

import pytest

from tests.test_structure import SOURCE

ROOMS = ("adapt", "arm", "board", "commission", "dashboard", "files/log", "identify", "measure", "tune")
# Numbers of the host in 1000 lines of it, whatever they are for: the fewest that there were. Fewer are better.
MOST_IN_1000_LINES = 7.6


def is_numeric(node: ast.expr) -> bool:
    """Whether an expression is made of numbers alone: 0.3, -1, 1 << 16, (0.1, 0.2)."""
    if isinstance(node, ast.Constant):
        return isinstance(node.value, int | float) and not isinstance(node.value, bool)
    if isinstance(node, ast.Tuple | ast.List):
        return bool(node.elts) and all(map(is_numeric, node.elts))
    if isinstance(node, ast.UnaryOp):
        return is_numeric(node.operand)
    return isinstance(node, ast.BinOp) and is_numeric(node.left) and is_numeric(node.right)


def numbers(target: ast.expr, value: ast.expr) -> Iterator[str]:
    """The names that an assignment gives to numbers; those of `A, B = 1, 2` one by one."""
    if isinstance(target, ast.Name) and is_numeric(value):
        yield target.id
    elif isinstance(target, ast.Tuple) and isinstance(value, ast.Tuple):
        for one, other in zip(target.elts, value.elts, strict=False):
            yield from numbers(one, other)


def constants(text: str) -> Iterator[tuple[str, bool]]:
    """The names of a module's numbers, each with whether a comment stands behind it or above its block."""
    lines = text.splitlines()
    for node in ast.parse(text).body:
        if isinstance(node, ast.Assign):
            found = [name for target in node.targets for name in numbers(target, node.value)]
        elif isinstance(node, ast.AnnAssign) and node.value is not None:
            found = list(numbers(node.target, node.value))
        else:
            continue
        above = list(takewhile(bool, reversed(lines[: node.lineno - 1])))
        own = lines[node.lineno - 1 : node.end_lineno]
        explained = any("#" in line for line in own) or any(line.startswith("#") for line in above)
        yield from ((name, explained) for name in found)


def test_a_modules_numbers_are_found_with_their_reasons() -> None:
    text = "A = 1  # why\nB: float = -0.5\n# why\nC, D = 2, 'x'\nE = (1, 2)\nF = A\n\nI = 2\ndef h():\n    K = 4"
    assert list(constants(text)) == [("A", True), ("B", False), ("C", True), ("E", True), ("I", False)]


@pytest.mark.parametrize("room", ROOMS)
def test_no_bare_number_stands_where_a_limit_belongs(room: str) -> None:
    """If one does: a judgement becomes a field of the room's limits.py; what is none gets its reason in a comment."""
    folder = SOURCE / "greywhale" / room
    assert [
        f"{path.relative_to(SOURCE)}: {name}"
        for path in sorted(folder.rglob("*.py"))
        if not str(path.relative_to(folder)).startswith(("limits.py", "limits/"))
        for name, explained in constants(path.read_text(encoding="utf-8"))
        if not explained
    ] == []


def test_the_host_has_no_more_bare_numbers_than_before() -> None:
    """If it has: inline what says no more than its expression, derive it from another, or give it to the limits."""
    texts = [path.read_text(encoding="utf-8") for path in (SOURCE / "greywhale").rglob("*.py")]
    lines = sum(len(text.splitlines()) for text in texts)
    assert 1000 * sum(len(list(constants(text))) for text in texts) / lines <= MOST_IN_1000_LINES
