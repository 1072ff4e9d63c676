"""The firmware's C++, compiled for this machine, equals the integer twin bit for bit."""

from __future__ import annotations

from dataclasses import fields, replace

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from numpy.typing import NDArray

from greywhale.fuzzy import twin
from greywhale.fuzzy.settings import JointSettings, load_joints
from tests.fuzzy.conftest import TABLES, Case, Points


@pytest.mark.slow
@settings(max_examples=200)
@given(data=st.data())
def test_every_intermediate(cases: st.SearchStrategy[Case], points: Points, data: st.DataObject) -> None:
    joint, period = data.draw(cases)
    e, ce = points(joint, period, data.draw(st.integers(0, 2**32 - 1)))
    controller, compiled = joint.controller(period), twin.compile_settings(joint, period)
    sides = [(side.zero, side.outer, side.short_ramps) for pair in (compiled.e, compiled.ce) for side in pair]
    coefficients = {"integral": compiled.integral, "ku_mv": compiled.ku_mv, "ce_ticks": compiled.ce_ticks}
    assert controller.coefficients == {"sides": sides, **coefficients}
    native = controller.infer(e.astype(np.int32), ce.astype(np.int32))
    ours = twin.infer(compiled, e, ce)
    assert len(native) == len(fields(ours)) - 1, "all but u"
    for name, values in native.items():
        column = f"{name}_e" if name in ("with", "against") else name
        np.testing.assert_array_equal(values, getattr(ours, column), err_msg=name)
    np.testing.assert_array_equal(controller.u(e.astype(np.int32), ce.astype(np.int32)), ours.u)


def _walk(random: np.random.Generator, length: int) -> NDArray[np.int64]:
    """Angles that move smoothly, jump, and sometimes sit at the ends of the format."""
    steps = random.normal(0.0, 10.0 ** random.uniform(0, 3.5), length)
    steps[random.random(length) < 0.02] *= 50
    return np.clip(np.cumsum(steps), -32768, 32767).astype(np.int64)


@pytest.mark.slow
@settings(max_examples=100)
@given(data=st.data())
def test_whole_trajectories(cases: st.SearchStrategy[Case], data: st.DataObject) -> None:
    """Integral, saturation, anti-windup, the supply's limit, a change of settings and period on the way, a reset."""
    random = np.random.default_rng(data.draw(st.integers(0, 2**32 - 1)))
    joint, period = data.draw(cases)
    native, ours = joint.controller(period), twin.Controller(joint, period)
    for part in range(3):
        length = 150
        leader, follower = _walk(random, length), _walk(random, length)
        limit = np.minimum(random.integers(0, 32768) + np.arange(length) * random.integers(0, 200), 32767)
        got = native.run(leader.astype(np.int16), follower.astype(np.int16), limit.astype(np.uint16))
        expected = ours.run(leader, follower, limit)
        for name in ("u_fuzzy", "volts_mv", "saturated", "no_rule"):
            np.testing.assert_array_equal(got[name], getattr(expected, name), err_msg=name)
        integral = [
            (int(whole) << 16) + int(part) for whole, part in zip(got["integral"], got["fraction"], strict=True)
        ]
        assert integral == expected.integral
        if part == 0:
            joint, period = data.draw(cases)
            native, ours = joint.controller(period), twin.Controller(joint, period)
        else:
            native.reset()
            ours.reset()


@pytest.mark.parametrize("sign", [1, -1])
def test_the_integral_stops_at_its_ends(sign: int) -> None:
    """While an error shrinks, the proportional part pulls back with all its 30 V, so no limit stops the integral."""
    settings = replace(load_joints(TABLES / "before_tuning.toml")[0], kp=0, kd=64 << 16, ki=20 << 16, ku_mv=30_000)
    error = np.concatenate([[32767], np.arange(32000, 3000, -200)])
    leader, follower = (error, np.zeros_like(error))[::sign]
    limit = np.full(len(error), 30_000)
    got = settings.controller(4).run(leader.astype(np.int16), follower.astype(np.int16), limit.astype(np.uint16))
    expected = twin.Controller(settings, 4).run(leader, follower, limit)
    reached = (int(got["integral"][-1]) << 16) + int(got["fraction"][-1])
    assert reached == expected.integral[-1] == (twin.INTEGRAL_END - 1 if sign > 0 else -twin.INTEGRAL_END)
    np.testing.assert_array_equal(got["volts_mv"], expected.volts_mv)


def test_the_paper_s_controllers_over_a_plane(paper_joints: tuple[JointSettings, ...]) -> None:
    for joint in paper_joints:
        for period in (1, 20):
            axis = np.arange(-32767, 32768, 173)
            e, ce = (grid.ravel() for grid in np.meshgrid(axis, axis // 7))
            native = joint.controller(period).u(e.astype(np.int32), ce.astype(np.int32))
            np.testing.assert_array_equal(native, twin.infer(twin.compile_settings(joint, period), e, ce).u)
