"""The picture of following: what is drawn is what was measured, and nothing overlaps."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from greywhale.files.log import Log
from greywhale.files.log.layout import Origin
from greywhale.pictures import follow, looks
from greywhale.pictures.follow import Trace, trace
from greywhale.pictures.page import style
from greywhale.protocol.table import ParameterTable
from tests.pictures.sight import faults


def log(gain: float, seed: int = 1) -> Log:
    time = np.arange(0, 4, 0.01)
    leader = np.column_stack([np.sin(time + joint) for joint in range(4)])
    state = np.where(time < 1, "soft_start", "following")
    noise = np.random.default_rng(seed).normal(0, 0.001, leader.shape)
    return Log("x.csv", Origin(), time, leader + noise, gain * leader, 0 * leader, state, 0, True)


def test_only_the_measured_part_is_drawn_and_starts_at_zero() -> None:
    one = trace(log(0.8), "before")
    assert one.time[0] == 0.0
    assert len(one.time) == 300
    assert one.mse[0] == pytest.approx(np.mean((one.leader[:, 0] - one.follower[:, 0]) ** 2))


def labels(traces: list[Trace]) -> list[str]:
    figure = follow.plot_following([replace(one, joints=(0,)) for one in traces], "Title")
    return [text.get_text() for text in figure.legends[0].get_texts()]


@pytest.mark.parametrize(("late_s", "lines"), [(0.02, ["leader"]), (0.2, ["leader, first", "leader, again"])])
def test_steps_that_are_played_again_are_one_leader_if_they_come_at_the_same_moment(
    late_s: float, lines: list[str]
) -> None:
    time = np.arange(0.0, 4.0, 0.005)
    first, again = (np.repeat((time > start)[:, None], 4, axis=1).astype(float) for start in (1.0, 1.0 + late_s))
    drawn = [Trace(name, time, rad, rad, (0.0,) * 4) for name, rad in (("first", first), ("again", again))]
    assert labels(drawn)[: len(lines)] == lines
    assert labels(drawn)[len(lines)] == "follower, first"


@pytest.mark.slow
@pytest.mark.parametrize(
    ("names", "size"),
    [(("log",), 0.4), (("before", "after tuning"), 0.02), (("a/…/log", "bb/…/log", "c" * 30, "d"), 0.0008)],
)
def test_nothing_is_cut_off_overlaps_or_lacks_a_unit(names: tuple[str, ...], size: float) -> None:
    # Reaches of a real log, and errors from those of a follower at rest to those of a step: the finer, the wider.
    time = np.arange(0, 20, 0.01)
    leader = np.column_stack([reach * np.sin(time + reach) - 0.1 for reach in (1.0, 0.65, 0.8, 1.2)])
    error = size * np.column_stack([np.sin(3 * time + joint) for joint in range(4)])
    one = Trace("", time, leader, leader - error, (0.000123, 0.1, 1.23e-5, 0.1), 9.0 * np.sin(leader), 12.0)
    with style():
        figure = follow.plot_following([replace(one, label=name) for name in names], "A title")
        assert faults(figure) == []


def test_a_noisy_voltage_shows_its_mean_and_the_leader_lies_on_top() -> None:
    time = np.arange(0, 2, 0.001)
    still = np.zeros((len(time), 4))
    buzz = np.where(np.arange(len(time)) % 2, 3.0, 1.0)[:, None] * np.ones(4)
    figure = follow.plot_following([Trace("log", time, still, still, (0.0,) * 4, buzz, 15.0)], "Title")
    angle, voltage = figure.axes[0].get_lines(), figure.axes[2].get_lines()
    assert max(angle, key=lambda line: line.get_zorder()).get_color() == looks.LEADER.colour
    raw, mean = voltage[-2:]
    assert raw.get_alpha() == 0.3
    np.testing.assert_allclose(np.asarray(mean.get_ydata())[50:-50], 2.0, atol=0.05)


def test_voltages_are_drawn_within_their_limit() -> None:
    """The limit is the supply where that is known, else the largest voltage in the logs."""
    one = trace(replace(log(0.8), voltage=6.0 * log(0.8).leader), "before")
    assert one.voltage is not None
    largest = f"largest voltage, {max(one.voltage.max(), -one.voltage.min()):.1f} V"
    assert labels([one]) == ["leader", "follower, before", "voltage", largest]
    known = replace(one, supply_v=12.0)
    assert labels([known])[-1] == "voltage limit, 12 V"
    assert labels([known, one])[-1] == "voltage limit, 12 V"
    figure = follow.plot_following([known], "Title")
    voltage = figure.axes[2]
    assert voltage.get_ylabel() == "voltage [V]"
    limits = voltage.get_lines()[:2]
    assert sorted(float(np.asarray(line.get_ydata())[0]) for line in limits) == [-12.0, 12.0]
    assert {line.get_linestyle() for line in limits} == {looks.VOLTAGE_LIMIT.style}
    np.testing.assert_array_equal(np.asarray(voltage.get_lines()[2].get_ydata()), one.voltage[:, 0])
    assert voltage.get_ylim()[0] < -12.0 < 12.0 < voltage.get_ylim()[1]


def test_the_supply_is_known_of_a_log_with_its_parameters_or_with_the_defaults() -> None:
    default = ParameterTable.defaults()
    with_table = Origin(param_crc=default.crc ^ 1, table=default.with_raw({"supply_mv": 7400}))
    assert trace(replace(log(0.8), origin=with_table), "x").supply_v == 7.4
    assert trace(replace(log(0.8), origin=Origin(param_crc=default.crc)), "x").supply_v == default.supply_v
    assert trace(replace(log(0.8), origin=Origin(param_crc=default.crc ^ 1)), "x").supply_v is None
    assert trace(log(0.8), "x", 9.0).supply_v == 9.0


@pytest.mark.slow
@pytest.mark.parametrize("joints", [(2,), (0, 1, 3)])
def test_only_joints_in_use_have_a_panel(joints: tuple[int, ...]) -> None:
    one = replace(trace(log(0.8), "before"), joints=joints)
    with style():
        figure = follow.plot_following([one], "A title")
        assert faults(figure) == []
        titles = [axes.get_title() for axes in figure.get_axes() if axes.get_title()]
        assert [title[:7] for title in titles] == [f"Joint {joint}" for joint in joints]
