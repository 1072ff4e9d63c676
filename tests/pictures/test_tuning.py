"""The pictures of a tuning: what is drawn is what was given, and nothing overlaps."""

from __future__ import annotations

from functools import cache

import numpy as np
import pytest
from matplotlib.figure import Figure
from matplotlib.lines import Line2D

from greywhale.base.types import Controllers, Floats
from greywhale.files.controller import load
from greywhale.files.paper_tables import paper_table
from greywhale.loop import controller_row, multi_steps
from greywhale.pictures import tuning as pictures
from greywhale.pictures.page import style
from greywhale.pictures.tuning import Response
from tests.pictures.sight import faults


def controllers(name: str) -> Controllers:
    return controller_row(load(paper_table(name)))


def motion() -> tuple[Floats, Floats, dict[str, Response]]:
    time = np.arange(0.0, 16.0, 0.005)
    leader = multi_steps().at(time)
    followers = {}
    for name, late in (("before tuning", 60), ("after tuning", 30), ("floor (ideal controller)", 20)):
        angles = np.vstack([np.repeat(leader[:1], late, axis=0), leader[:-late]])
        followers[name] = Response(time, angles, np.mean((leader - angles) ** 2, axis=0))
    return time, leader, followers


def x_of(line: Line2D) -> Floats:
    return np.asarray(line.get_xdata(), dtype=np.float64)


def y_of(line: Line2D) -> Floats:
    return np.asarray(line.get_ydata(), dtype=np.float64)


@cache
def figure_of(name: str) -> Figure:
    """Tests only look at it."""
    with style():
        if name == "sets":
            return pictures.plot_sets(controllers("before_tuning"), controllers("table_10"))
        if name == "unchanged sets":
            return pictures.plot_sets(controllers("before_tuning"), controllers("before_tuning"))
        if name == "responses":
            return pictures.plot_responses(*motion(), "Response to multi-steps")
        evaluations = np.arange(10, 310, 10)
        cost = pictures.cost_words("default")
        costs = [np.maximum(scale / evaluations, 1.2e-3 * scale) for scale in (1e-3, 1.0, 123456.0, 7e5)]
        return pictures.plot_convergence([(evaluations, one) for one in costs], "Convergence", cost)


@pytest.mark.slow
@pytest.mark.parametrize("name", ["sets", "unchanged sets", "responses", "convergence"])
def test_nothing_is_cut_off_overlaps_or_lacks_a_unit(name: str) -> None:
    with style():
        assert faults(figure_of(name)) == []


def test_the_sets_have_their_corners_where_the_board_has_them() -> None:
    figure = figure_of("sets")
    error, change = figure.axes[0], figure.axes[1]
    assert "Joint 0, base yaw: error" in error.get_title()
    lines = {(line.get_linestyle(), index % 3): line for index, line in enumerate(error.get_lines())}
    np.testing.assert_allclose(x_of(lines["--", 1]), [-0.3, 0.0, 0.3], atol=1e-4)
    np.testing.assert_allclose(x_of(lines["-", 0]), [-1.0, -0.0785, 0.0], atol=1e-4)
    np.testing.assert_allclose(y_of(lines["-", 2]), [0.0, 1.0, 1.0])
    np.testing.assert_allclose(x_of(change.get_lines()[5]), [0.0, 1.0, 1.0], atol=1e-4)


def test_responses_show_every_follower_its_error_and_its_figure() -> None:
    time, _, followers = motion()
    figure = figure_of("responses")
    assert len(figure.axes) == 12
    whole, error, near = figure.axes[:3]
    assert len(whole.get_lines()) == 4
    np.testing.assert_array_equal(y_of(whole.get_lines()[2]), followers["after tuning"].angles[:, 0])
    assert f"after {followers['after tuning'].mse[0]:#.3g}" in whole.get_title(loc="left")
    assert (whole.get_ylabel(), error.get_ylabel()) == ("angle [rad]", "error [rad]")
    first, last = near.get_xlim()
    assert first < 11.0 < last, "the largest of the steps, 1.2 rad, comes at 11 s"
    assert [text.get_text() for text in figure.legends[0].get_texts()][:4] == ["leader", *followers]
    assert time[0] == whole.get_xlim()[0]


@pytest.mark.slow
@pytest.mark.parametrize("joints", [(2,), (0, 1, 3)])
def test_only_joints_in_use_have_a_panel(joints: tuple[int, ...]) -> None:
    costs = [(np.arange(10, 310, 10), 1.0 / np.arange(10, 310, 10))] * 4
    with style():
        figures = (
            pictures.plot_sets(controllers("before_tuning"), controllers("table_10"), joints),
            pictures.plot_responses(*motion(), "Response to multi-steps", joints),
            pictures.plot_convergence(costs, "Convergence", pictures.cost_words("default"), joints),
        )
        for figure in figures:
            assert faults(figure) == []
            told = " ".join(axes.get_title() + axes.get_title(loc="left") for axes in figure.get_axes())
            assert {joint for joint in range(4) if f"Joint {joint}" in told} == set(joints)
