"""The integer law stays within its bound of the exact law: 1 LSB of q15 for u_fuzzy (docs/fuzzy.md derives it)."""

from __future__ import annotations

from collections.abc import Callable
from fractions import Fraction

import numpy as np
from hypothesis import assume, given, settings
from hypothesis import strategies as st
from numpy.typing import NDArray

from greywhale.fuzzy import exact, twin
from greywhale.fuzzy.settings import JointSettings

Case = tuple[JointSettings, int]
Points = Callable[[JointSettings, int, int], tuple[NDArray[np.int64], NDArray[np.int64]]]

Q15 = 1 << 15
ANGLE = 4096


def _check(joint: JointSettings, period: int, e: NDArray[np.int64], ce: NDArray[np.int64]) -> None:
    law = exact.Law(joint, period)
    u = twin.infer(twin.compile_settings(joint, period), e, ce).u
    for error, change, ours in zip(e.tolist(), ce.tolist(), u.tolist(), strict=True):
        difference = ours - Q15 * law.infer(Fraction(error, ANGLE), Fraction(change, ANGLE)).u
        assert abs(difference) < 1, (joint, period, error, change, float(difference))


@settings(max_examples=200)
@given(data=st.data())
def test_u_fuzzy_is_within_one_lsb(cases: st.SearchStrategy[Case], points: Points, data: st.DataObject) -> None:
    joint, period = data.draw(cases)
    e, ce = points(joint, period, data.draw(st.integers(0, 2**32 - 1)))
    _check(joint, period, e[:40], ce[:40])


def test_u_fuzzy_of_the_paper_s_controllers(paper_joints: tuple[JointSettings, ...], points: Points) -> None:
    for number, joint in enumerate(paper_joints):
        for period in (1, 20):
            e, ce = points(joint, period, number)
            _check(joint, period, e, ce)


@settings(max_examples=200)
@given(data=st.data())
def test_volts_of_one_step(cases: st.SearchStrategy[Case], data: st.DataObject) -> None:
    """From the same memory, volts differ by Ku's share of u_fuzzy's bound and the rounding to mV."""
    joint, period = data.draw(cases)
    law, ours = exact.Law(joint, period), twin.Controller(joint, period)
    ours.integral = data.draw(st.integers(-twin.INTEGRAL_END, twin.INTEGRAL_END - 1))
    ours.previous = data.draw(st.integers(-32767, 32767))
    leader, follower = (data.draw(st.integers(-32768, 32767)) for _ in range(2))
    limit = data.draw(st.integers(0, 30_000))

    state = exact.State(Fraction(ours.previous, ANGLE), Fraction(ours.integral, 1000 << 31))
    output, after = law.step(state, Fraction(leader, ANGLE), Fraction(follower, ANGLE), Fraction(limit, 1000))
    run = ours.run([leader], [follower], [limit])

    bound = joint.ku_mv / Q15 + 0.5 + 2**-14
    # Nearer to the limit than the bound, the two may decide differently whether to integrate.
    assume(abs(abs(float(output.wanted)) * 1000 - limit) > bound)
    assert run.saturated[0] == output.saturated
    assert abs(run.volts_mv[0] - 1000 * output.volts) <= bound
    assert abs(Fraction(run.integral[0], 1000 << 31) - after.integral) <= Fraction(1, 1000 << 31)
