"""The integer law stays within its bound of the exact law: 1 LSB of q15 for u_fuzzy. The bound comes from here:

Units: U = 1/(2^24 - 1), the last bit of a height; 1 LSB = 2^-15.

Heights. Rounding costs 1/2 U. A slope is off by at most 1/2, which moves a height by at most 1/4 U: size/2^17 on a
long ramp (sizes have 15 bits), 128/512 on a short one, less than 1/200 U on a medium one. A rising ramp's slope,
rounded to 24 bits, has a relative error of at most r = 2^-17 instead. For sizes of E and more, falling ramps give
exactly 1 and rising ones at least 1 - r. So with d = 3/4 U:

- falling: |error| <= d
- rising: |error| <= 1/2 U + r h; min and max do not enlarge errors.

Sensitivity. With S = hN + hZ + hP and u >= 0 (the other sign mirrors it), to first order

|du| <= [(1 - u) |dhP| + (1 + u) |dhN| + u |dhZ|] / S

- Same signs: hN = 0 without error, so |du| <= max(|dhP|, |dhZ|) / S.
- Opposite signs: let p, n, z = hP/S, hN/S, hZ/S. hZ >= min(a, b) >= min(hN, hP), so z >= min(p, n). If u is near 1,
  hN and hZ come from two *different* ramps, one falling, one rising: if hN and hZ were both equal to a, A <= a
  would be needed, hence hP <= hN. The worst assignment is |dhN| = d, |dhZ| = U/2 + r hZ.
- S is never small. In each input the two ramps cross at E1/(E1 + E2) >= 164/(164 + 16384) = h0 = 0.00991 or higher.
  The largest of the nine minima is at least the smaller of these two crossings, so S >= h0 / max(p, n, z).

The relative errors contribute at most r [(1 - u) p + (1 + u) n + u z] (0.25 LSB times the bracket), the absolute ones
[(1 - u) d + (1 + u) d + u U/2] max(p, n, z) / h0 (0.197 LSB a U). Maximised over p + n + z = 1, z >= n, that is 0.413
LSB.

Division. R (1 + E + E²) leaves out E³ < 2^-22. With the truncations, the quotient before the last rounding is too
small by at most 0.034 LSB (17 of 512; in the table of `ratio_q15`'s steps: E³ 3, E² from E's upper byte 6, the last
bits of E and E² 4, the last product 6; not all at once). Where whole is shifted right, S >= 1 and the two lost bits
weigh 2^-22.

Rounding to q15: 0.5 LSB.

The sum is 0.95 LSB, for all settings that compile() takes.
"""

from __future__ import annotations

import math
from dataclasses import replace
from fractions import Fraction

import numpy as np
import pytest
from hypothesis import assume, given, settings
from hypothesis import strategies as st
from numpy.typing import NDArray

from greywhale.fuzzy import exact, twin
from greywhale.fuzzy.settings import LARGEST_K, SET_UNIT, JointSettings
from tests.fuzzy.conftest import Case, Points

Q15 = 1 << 15
ANGLE = 4096
FALLING = 0.75  # a falling ramp's error, in bits of a height
PLAIN = JointSettings(-8192, -8192, 8192, 8192, -8192, -8192, 8192, 8192, kp=65536, kd=65536, ki=0, ku_mv=12_000)


def _check(joint: JointSettings, period: int, e: NDArray[np.int64], ce: NDArray[np.int64]) -> None:
    law = exact.Law(joint, period)
    u = twin.infer(twin.compile_settings(joint, period), e, ce).u
    for error, change, ours in zip(e.tolist(), ce.tolist(), u.tolist(), strict=True):
        difference = ours - Q15 * law.infer(Fraction(error, ANGLE), Fraction(change, ANGLE)).u
        assert abs(difference) < 1, (joint, period, error, change, float(difference))


@pytest.mark.slow
@settings(max_examples=100)
@given(data=st.data())
def test_u_fuzzy_is_within_one_lsb(cases: st.SearchStrategy[Case], points: Points, data: st.DataObject) -> None:
    joint, period = data.draw(cases)
    e, ce = points(joint, period, data.draw(st.integers(0, 2**32 - 1)))
    _check(joint, period, e[:40], ce[:40])


def test_u_fuzzy_of_the_paper_s_controllers(paper_joints: tuple[JointSettings, ...], points: Points) -> None:
    for number, joint in enumerate(paper_joints):
        for period in (1, 20):
            e, ce = points(joint, period, number)
            _check(joint, period, e[:100], ce[:100])


@pytest.mark.slow
@settings(max_examples=100)
@given(data=st.data())
def test_volts_of_one_step(cases: st.SearchStrategy[Case], data: st.DataObject) -> None:
    """From the same memory, volts differ by Ku's share of u_fuzzy's bound and the rounding to mV."""
    joint, period = data.draw(cases)
    law, ours = exact.Law(joint, period), twin.Controller(joint, period)
    ours.integral = data.draw(st.integers(-twin.INTEGRAL_END, twin.INTEGRAL_END - 1))
    ours.errors = np.array(
        data.draw(st.lists(st.integers(-32767, 32767), min_size=joint.ce_ticks, max_size=joint.ce_ticks))
    )
    leader, follower = (data.draw(st.integers(-32768, 32767)) for _ in range(2))
    limit = data.draw(st.integers(0, 30_000))

    state = exact.State(tuple(Fraction(e, ANGLE) for e in ours.errors.tolist()), Fraction(ours.integral, 1000 << 31))
    output, after = law.step(state, Fraction(leader, ANGLE), Fraction(follower, ANGLE), Fraction(limit, 1000))
    run = ours.run([leader], [follower], [limit])

    bound = joint.ku_mv / Q15 + 0.5 + 2**-14
    # Nearer to the limit than the bound, the two may decide differently whether to integrate.
    assume(abs(abs(float(output.wanted)) * 1000 - limit) > bound)
    assert run.saturated[0] == output.saturated
    assert abs(run.volts_mv[0] - 1000 * output.volts) <= bound
    assert abs(Fraction(run.integral[0], 1000 << 31) - after.integral) <= Fraction(1, 1000 << 31)
    assert after.errors == tuple(Fraction(e, ANGLE) for e in ours.errors.tolist())


def test_falling_heights_are_within_three_quarters_of_a_bit() -> None:
    """Ramps of every length up to 600 sizes, among them the short and the medium ones, at every size."""
    sizes = np.arange(700)
    random, shifts = np.random.default_rng(0), set()
    for end in [*range(1, 601), 127.99, 128.01, 255.99, 256.01, *random.uniform(1, 600, 200)]:
        width = int(random.integers(1000, 16384))
        joint = replace(PLAIN, ze_c=width, kp=min(round(width * SET_UNIT / end), LARGEST_K))
        coefficients = twin.compile_settings(joint, 20)
        ours = twin.infer(coefficients, sizes, 0).e_zero
        full = Fraction(width * SET_UNIT, joint.kp)
        exactly = twin.ONE * np.maximum(0, 1 - sizes * joint.kp / (width * SET_UNIT))
        assert np.abs(ours - exactly).max() <= FALLING + 1e-6, joint
        np.testing.assert_array_equal(ours[math.ceil(full) :], 0)
        shifts.add(coefficients.e[0].zero_shift)
    assert shifts == {0, 1, 8}


def test_the_maximum_that_the_derivation_states() -> None:
    """The share of the heights' errors over all p, n, z."""
    part = np.linspace(0, 1, 1001)
    p, n = np.meshgrid(part, part)
    z, u = 1 - p - n, p - n
    allowed = (z >= n - 1e-12) & (p >= n)
    least, last_bit, relative = 164 / (164 + 16384), 1 / ((1 << 24) - 1), 2.0**-17
    absolute = ((1 - u) * FALLING + (1 + u) * FALLING + u * 0.5) * last_bit * np.maximum(np.maximum(p, n), z) / least
    total = absolute + relative * ((1 - u) * p + (1 + u) * n + u * z)
    assert 0.411 < np.where(allowed, total, 0).max() * Q15 <= 0.413


def test_the_quotient_s_error_that_the_derivation_states() -> None:
    """Before its rounding the quotient is at most 0.034 LSB low, so a rounded one is within 0.5 + 0.034 below."""
    random = np.random.default_rng(0)
    whole = np.concatenate([random.integers(1 << 23, 1 << 24, 500_000), (np.arange(256, 512) << 15) + 32767])
    part = (whole * np.concatenate([random.random(400_000), np.ones(len(whole) - 400_000)])).astype(np.int64)
    error = twin.ratio_q15(part, whole) - Q15 * part / whole
    assert error.max() <= 0.5
    assert error.min() >= -0.534
