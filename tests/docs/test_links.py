"""Links in README.md and its like lead somewhere too, and files that pages name exist."""

from __future__ import annotations

import re
from pathlib import Path

import pytest

from tools import ROOT
from tools.docs.links import broken, links, pages

TOP = ("docs", "firmware", "host", "shared", "sim", "tests", "tools", ".ci")
NAMED = re.compile(rf"`((?:{'|'.join(map(re.escape, TOP))})/[\w./-]+)`")
# Folders of what is built, and a name that stands for many.
NOT_THERE = ("docs/verbs/VERB.md",)


def test_links_inside_of_the_project_lead_somewhere() -> None:
    inside = [link for page in pages() for link in links(page) if not link.is_external]
    assert len(inside) > 100
    assert [problem for link in inside if (problem := broken(link))] == []


@pytest.mark.parametrize("page", pages(), ids=lambda page: str(page.relative_to(ROOT)))
def test_files_that_a_page_names_exist(page: Path) -> None:
    named = set(NAMED.findall(page.read_text(encoding="utf-8"))) - set(NOT_THERE)
    assert [name for name in sorted(named) if not (ROOT / name).exists()] == []
