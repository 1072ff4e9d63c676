"""The page of limits, and the header that tells them to compiled code, are made from the code."""

from __future__ import annotations

from tools.generate.limits import main


def test_page_and_header_of_limits_are_current() -> None:
    """If not: `python -m tools.generate`."""
    assert main(["--check"]) == 0
