"""Every command and every Python example of README.md and docs/ runs; `running` states the rule."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import pytest

from tests.docs.running import parse, run_block, run_line
from tools import ROOT
from tools.docs.examples import Block, blocks, split
from tools.docs.links import pages

SHOWN = {page: list(blocks(page)) for page in pages()}
# So many blocks are only parsed because their page says so.
MARKED = 0


@pytest.mark.slow
@pytest.mark.parametrize(
    "page", [page for page, found in SHOWN.items() if found], ids=lambda page: str(page.relative_to(ROOT))
)
def test_what_a_page_shows_runs(page: Path, scratch: Path, fresh_board: None, once: None) -> None:
    names: dict[str, Any] = {"__name__": "__main__"}
    for block in SHOWN[page]:
        run_block(block, names)


def test_few_blocks_are_only_parsed() -> None:
    found = [block for page in SHOWN.values() for block in page]
    assert len(found) > 55
    assert sum(bool(block.parsed_only) for block in found) == MARKED


def test_every_verb_is_shown_by_an_example() -> None:
    from greywhale.cli.verbs import VERBS

    lines = [
        split(line) for page in SHOWN.values() for block in page if block.language == "sh" for line in block.commands
    ]
    shown = {word for line in lines for word in line.words[1:3]}
    assert set(VERBS) <= shown


@pytest.mark.parametrize(
    ("line", "problem"),
    [
        ("greywhale recrod", "No such command 'recrod'"),
        ("greywhale calibrate --secnod 1", "No such option '--secnod'"),
        ("greywhale evaluate none.csv", "1: greywhale: none.csv: cannot be read"),
        ("make nothing", "there is no target nothing"),
        ('make demo ARGS="--leadr m.csv"', "No such option '--leadr'"),
        ("python -m tools.nothing", "there is no module tools.nothing"),
        ("rm -rf build", "a test must learn what this is"),
    ],
)
def test_a_command_that_does_not_work_is_found(line: str, problem: str) -> None:
    assert problem in run_line(line)


def test_python_that_does_not_work_is_found() -> None:
    with pytest.raises(NameError, match="nothing"):
        run_block(Block(ROOT / "README.md", 1, "python", "nothing.at_all()\n", ""), {})


def test_what_is_parsed_is_not_run(scratch: Path) -> None:
    assert parse(["params", "set", "joint0.kp=1", "--port", "/dev/none"]) == ""
    assert parse(["record", "--enable", "--out", "none.csv"]) == ""
    assert not (scratch / "none.csv").exists()
