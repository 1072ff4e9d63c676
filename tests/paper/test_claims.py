"""A claim is judged by both arms and enough seeds."""

from __future__ import annotations

import pytest

from greywhale_paper.optimisers.significance import fewest
from greywhale_paper.pages.claims import judge


@pytest.mark.parametrize(
    ("default", "sticky", "seeds", "said"),
    [
        (True, True, 4, "reproduces"),
        (False, True, 10, "on an arm like the paper's"),
        (True, False, 10, "on the default arm"),
        (False, False, 10, "does not"),
        (True, True, 3, "open: 3 of 4 seeds"),
    ],
)
def test_a_claim_needs_both_arms_and_enough_seeds(default: bool, sticky: bool, seeds: int, said: str) -> None:
    assert judge(default, sticky, seeds, fewest()) == said
