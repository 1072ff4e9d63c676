"""Promises of the law, checked on the exact reference and on the integers."""

from __future__ import annotations

from dataclasses import replace
from fractions import Fraction

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from greywhale.fuzzy import exact, twin
from greywhale.fuzzy.settings import GAIN_UNIT, JointSettings
from greywhale.protocol.schema import Refusal
from tests.fuzzy.conftest import Case, Points

Q15 = 1 << 15
PLAIN = JointSettings(-4915, -4915, 4915, 4915, -1638, -1638, 1638, 1638, 33620, 10486, 20513, 15000)


def _mirrored(joint: JointSettings) -> JointSettings:
    return replace(
        joint,
        ne_c=-joint.pe_b,
        ze_a=-joint.ze_c,
        ze_c=-joint.ze_a,
        pe_b=-joint.ne_c,
        nce_c=-joint.pce_b,
        zce_a=-joint.zce_c,
        zce_c=-joint.zce_a,
        pce_b=-joint.nce_c,
    )


@pytest.mark.slow
@settings(max_examples=100)
@given(data=st.data())
def test_mirrored_sets_mirror_the_output(cases: st.SearchStrategy[Case], points: Points, data: st.DataObject) -> None:
    """Odd symmetry, also for symmetric sets, which are their own mirror image."""
    joint, period = data.draw(cases)
    e, ce = points(joint, period, data.draw(st.integers(0, 2**32 - 1)))
    u = twin.infer(twin.compile_settings(joint, period), e, ce).u
    mirrored = twin.infer(twin.compile_settings(_mirrored(joint), period), -e, -ce).u
    np.testing.assert_array_equal(u, -mirrored)


@pytest.mark.slow
@settings(max_examples=100)
@given(data=st.data())
def test_output_is_within_one_and_some_rule_fires(
    cases: st.SearchStrategy[Case], points: Points, data: st.DataObject
) -> None:
    joint, period = data.draw(cases)
    e, ce = points(joint, period, data.draw(st.integers(0, 2**32 - 1)))
    ours = twin.infer(twin.compile_settings(joint, period), e, ce)
    assert np.abs(ours.u).max() <= Q15
    assert not ours.no_rule.any()
    # The least sum of heights that widths of 0.01 and more allow: 0.01 / (1 + 0.01), rounded as the sets are.
    assert (ours.with_e + ours.zero + ours.against_e).min() >= 164 / (16384 + 164) * twin.ONE - 3


@pytest.mark.slow
@settings(max_examples=100)
@given(data=st.data())
def test_no_error_no_output_and_no_change_of_sides(cases: st.SearchStrategy[Case], data: st.DataObject) -> None:
    joint, period = data.draw(cases)
    size = np.arange(0, 32768, 97)
    ours = twin.infer(twin.compile_settings(joint, period), np.concatenate([size, -size]), 0).u
    assert ours[0] == 0
    assert (ours[: len(size)] >= 0).all()
    assert (ours[len(size) :] <= 0).all()


@pytest.mark.parametrize("ticks", [1, 2, 20])
def test_the_change_spans_so_many_periods(ticks: int) -> None:
    """An error that grows evenly: its change is 0 until it has been seen for so long, then that of the whole span."""
    joint, law = replace(PLAIN, ce_ticks=ticks), exact.Law(replace(PLAIN, ce_ticks=ticks), 1)
    state, u = exact.State(), []
    for k in range(2 * ticks + 1):
        output, state = law.step(state, Fraction(10 * k, 4096), Fraction(0), Fraction(100))
        u.append(output.u_fuzzy)
        change = Fraction(10 * ticks if k >= ticks else 0, 4096)
        assert output.u_fuzzy == law.infer(Fraction(10 * k, 4096), change).u
    ours = twin.Controller(joint, 1).run(10 * np.arange(2 * ticks + 1), 0, 32767)
    assert np.abs(ours.u_fuzzy - np.array([float(one) for one in u]) * Q15).max() <= 1


def test_the_exact_law_is_the_weighted_singletons_of_table_6() -> None:
    """One point worked out by hand."""
    sets = {name: Fraction(value) for name, value in zip(
        ("ne_c", "ze_a", "ze_c", "pe_b", "nce_c", "zce_a", "zce_c", "pce_b"),
        ("-1/2", "-1/2", "1/2", "1/4", "-1/5", "-1/5", "1/5", "1/5"),
        strict=True,
    )}  # fmt: skip
    # x = 1/8: ZE 3/4, PE 1/2. y = -1/20: ZCE 3/4, NCE 1/4. PU: min(1/2, 3/4); NU: min(3/4, 1/4); ZU: 3/4.
    found = exact.infer(Fraction(1, 8), Fraction(-1, 20), sets)
    assert found.heights == {"PU": Fraction(1, 2), "NU": Fraction(1, 4), "ZU": Fraction(3, 4)}
    assert found.u == Fraction(1, 6)


@pytest.mark.slow
@settings(max_examples=200)
@given(data=st.data())
def test_what_is_refused_has_no_controller(data: st.DataObject) -> None:
    corner = st.one_of(
        st.sampled_from([0, 1, 163, 164, 16384, 16385, 32767]), st.integers(164, 16384), st.integers(-300, 300)
    )
    signs = (-1, -1, 1, 1, -1, -1, 1, 1)
    values = [sign * data.draw(corner) for sign in signs]
    gain = st.sampled_from([0, 1, GAIN_UNIT, 64 * GAIN_UNIT, 64 * GAIN_UNIT + 1, 2**32 - 1])
    ki = st.sampled_from([0, GAIN_UNIT, 1000 * GAIN_UNIT, 1000 * GAIN_UNIT + 1, (1 << 28) - 1, 1 << 28, 1 << 27])
    values += [data.draw(gain), data.draw(gain), data.draw(ki), data.draw(st.sampled_from([0, 30_000, 30_001]))]
    values.append(data.draw(st.sampled_from([0, 1, 20, 21])))
    joint = JointSettings(*values)
    period = data.draw(st.sampled_from([0, 1, 2, 4, 20, 50, 51, 255]))
    if joint.refusal(period) is Refusal.NONE:
        joint.controller(period)
    else:
        with pytest.raises(ValueError, match="refused"):
            joint.controller(period)
