"""Code that many verbs share names no option of one of them: its sentences come from any."""

from __future__ import annotations

import ast
import re
from collections.abc import Iterator
from pathlib import Path

import greywhale

ROOT = Path(greywhale.__file__).parent
# Each of these serves the verb of its name alone, and may name its options.
OF_ONE_VERB = ("board/flash", "board/doctor", "board/calibrate")
# Every verb with a board has it; a command that is named in whole may have any.
OF_ALL = {"--port"}


def sentences(module: Path) -> Iterator[str]:
    """All strings of a module but what documents it."""
    tree = ast.parse(module.read_text(encoding="utf-8"))
    documents = {
        node.body[0].value
        for node in ast.walk(tree)
        if isinstance(node, ast.Module | ast.ClassDef | ast.FunctionDef)
        and node.body
        and isinstance(node.body[0], ast.Expr)
    }
    for node in ast.walk(tree):
        if isinstance(node, ast.Constant) and isinstance(node.value, str) and node not in documents:
            yield node.value


def options_in(sentence: str) -> set[str]:
    """The options that a sentence names by themselves, not in a command such as `greywhale flash --port X`."""
    alone = re.sub(r"`(greywhale|sudo|pio|pip|xacro) [^`]*(`|$)", "", sentence)
    return set(re.findall(r"(?<![\w-])--[a-z][a-z-]*", alone))


def test_what_all_verbs_with_a_board_share_names_no_option_of_one() -> None:
    modules = [
        module
        for room in ("board", "protocol")
        for module in (ROOT / room).rglob("*.py")
        if not module.relative_to(ROOT).as_posix().startswith(OF_ONE_VERB) and module.name != "joints.py"
    ]
    assert len(modules) > 15
    named = {(module.name, option) for module in modules for text in sentences(module) for option in options_in(text)}
    assert {(name, option) for name, option in named if option not in OF_ALL} == set()
