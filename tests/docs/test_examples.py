"""Every command and every Python example of README.md and docs/ runs; `running` states the rule."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import pytest

from tests.docs.running import run_block
from tools import ROOT
from tools.docs.examples import blocks, split
from tools.docs.links import pages

SHOWN = {page: list(blocks(page)) for page in pages()}


@pytest.mark.slow
@pytest.mark.parametrize(
    "page", [page for page, found in SHOWN.items() if found], ids=lambda page: str(page.relative_to(ROOT))
)
def test_what_a_page_shows_runs(page: Path, scratch: Path, fresh_board: None, once: None) -> None:
    names: dict[str, Any] = {"__name__": "__main__"}
    for block in SHOWN[page]:
        run_block(block, names)


def test_every_verb_is_shown_by_an_example() -> None:
    from greywhale.cli.verbs import all_verbs

    lines = [
        split(line) for page in SHOWN.values() for block in page if block.language == "sh" for line in block.commands
    ]
    shown = {word for line in lines for word in line.words[1:3]}
    assert set(all_verbs()) <= shown
