"""The page of limits is made from the code."""

from __future__ import annotations

from tools.generate.limits import main


def test_the_page_of_limits_is_current() -> None:
    """If not: `python -m tools.generate`."""
    assert main(["--check"]) == 0
