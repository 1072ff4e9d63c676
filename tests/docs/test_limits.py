"""The header that tells limits to compiled code is current, and what pages get from the code has its place there."""

from __future__ import annotations

from tools import ROOT
from tools.docs.made import MADE
from tools.generate.limits import main


def test_the_header_of_limits_is_current() -> None:
    """If not: `python -m tools.generate`."""
    assert main(["--check"]) == 0


def test_what_is_made_has_its_place_on_a_page() -> None:
    pages = [path.read_text(encoding="utf-8") for path in (ROOT / "docs").glob("*.md")]
    assert all(sum(page.count(marker) for page in pages) == 1 for marker in MADE)
    assert sum(page.count("<!-- limits: ") for page in pages) == sum("limits" in marker for marker in MADE)
