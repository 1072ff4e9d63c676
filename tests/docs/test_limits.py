"""The page of limits, and the header that declares them to compiled code, are made from the code."""

from __future__ import annotations

from tools.generate import limits, score_limits


def test_the_page_of_limits_is_current() -> None:
    """If not: `python -m tools.generate`."""
    assert limits.main(["--check"]) == 0


def test_the_header_of_limits_is_current() -> None:
    """If not: `python -m tools.generate`."""
    assert score_limits.main(["--check"]) == 0
