"""The links of the project's Markdown: where each points, and the anchors that a page has.

Sphinx checks those between pages of the site; this module knows README.md and its like too. Nothing opens a link to the
web.
"""

from __future__ import annotations

import re
from collections.abc import Iterator
from dataclasses import dataclass
from pathlib import Path

from tools import ROOT

FENCE = re.compile(r"^(```+|~~~+).*?^\1$", re.MULTILINE | re.DOTALL)
LINK = re.compile(r"\[[^\]]*\]\(([^)\s]+)\)")
HEADING = re.compile(r"^#+ +(.+?) *$", re.MULTILINE)


@dataclass(frozen=True)
class Link:
    page: Path
    target: str

    @property
    def is_external(self) -> bool:
        return re.match(r"[a-z]+:", self.target) is not None


def pages() -> list[Path]:
    """All Markdown that people read: the pages at the root and those of the site."""
    return [*sorted(ROOT.glob("*.md")), *sorted((ROOT / "docs").rglob("*.md"))]


def links(page: Path) -> Iterator[Link]:
    """The links of a page, without what stands in blocks of code."""
    for found in LINK.finditer(without_code(page)):
        yield Link(page, found[1])


def broken(link: Link) -> str:
    """The fault of a link inside of the project, "" for none."""
    path, _, anchor = link.target.partition("#")
    target = (link.page.parent / path).resolve() if path else link.page
    if not target.exists():
        return f"{link.page.relative_to(ROOT)}: {link.target}: there is no such file"
    if anchor and anchor not in anchors(target):
        return f"{link.page.relative_to(ROOT)}: {link.target}: there is no such heading"
    return ""


def anchors(page: Path) -> set[str]:
    """The anchors of a page's headings, as forges and MyST make them."""
    headings = (re.sub(r"[`*]|\[|\]\([^)]*\)", "", found[1]) for found in HEADING.finditer(without_code(page)))
    return {re.sub(r"[^\w\- ]", "", heading.lower()).replace(" ", "-") for heading in headings}


def without_code(page: Path) -> str:
    return FENCE.sub("", page.read_text(encoding="utf-8"))
