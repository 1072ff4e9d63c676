"""The law in plain floats, which the errata and the feet are studied with, is the exact law."""

from __future__ import annotations

from fractions import Fraction

import numpy as np
import pytest

from greywhale.fuzzy.exact import Feet, infer
from greywhale.fuzzy.settings import JointSettings
from greywhale.reproduce.work.errata import Law
from greywhale.reproduce.work.motions import printed


@pytest.mark.parametrize("table", ["before_tuning", "table_9", "table_10"])
@pytest.mark.parametrize(("feet", "crisp"), [(Feet.AT_ZERO, False), (Feet.CRISP, True)])
def test_floats_are_the_exact_law(table: str, feet: Feet, crisp: bool) -> None:
    rows = printed(table)
    law = Law.of(rows, crisp)
    law = Law(law.sets, np.ones((4, 4)), crisp)
    random = np.random.default_rng(3)
    for x, y in random.uniform(-1.0, 1.0, (200, 2)):
        found, silent = law.fuzzy(np.full(4, x), np.full(4, y))
        for joint, row in enumerate(rows):
            sets = JointSettings(*map(int, row)).set_values()
            exact = infer(Fraction(float(x)), Fraction(float(y)), sets, feet)
            assert found[joint] == pytest.approx(float(exact.u), abs=1e-12)
            assert bool(silent[joint]) == exact.no_rule


def test_a_rate_is_the_change_over_the_period() -> None:
    rows = printed("before_tuning")
    plain, rate = Law.of(rows), Law.of(rows, rate=True)
    e, change = np.full(4, 0.1), np.full(4, 0.0004)
    assert rate.fuzzy(e, change)[0] == pytest.approx(plain.fuzzy(e, 50.0 * change)[0])
