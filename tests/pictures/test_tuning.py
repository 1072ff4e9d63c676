"""The pictures of a tuning: what is drawn is what was given, nothing overlaps, the same numbers give the same bytes."""

from __future__ import annotations

from dataclasses import replace
from functools import cache
from pathlib import Path
from types import SimpleNamespace
from typing import cast

import matplotlib.pyplot as plt
import numpy as np
import pytest
from matplotlib.figure import Figure
from matplotlib.lines import Line2D

from greywhale.base.errors import UserError
from greywhale.base.types import Controllers, Floats
from greywhale.files.controller import load
from greywhale.files.paper_tables import paper_table
from greywhale.motion import multi_steps
from greywhale.pictures import looks
from greywhale.pictures import tuning as pictures
from greywhale.pictures.page import style
from greywhale.pictures.tuning import Response
from greywhale.simulate import controller_row
from greywhale.tune.report.pictures import draw
from greywhale.tune.result import TuningResult
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


def test_sets_that_did_not_change_are_drawn_once_and_said_to_be_unchanged() -> None:
    figure = figure_of("unchanged sets")
    assert "unchanged" in figure.get_suptitle()
    assert [text.get_text() for text in figure.legends[0].get_texts()] == ["NE / NCE", "ZE / ZCE", "PE / PCE"]
    assert {len(axes.get_lines()) for axes in figure.axes} == {3}
    assert {line.get_linestyle() for axes in figure.axes for line in axes.get_lines()} == {"-"}


def test_a_panel_without_change_says_so_among_others() -> None:
    before, after = controllers("before_tuning"), controllers("before_tuning").copy()
    after[2] = controllers("table_10")[2]
    figure = pictures.plot_sets(before, after)
    unchanged = ["unchanged" in axes.get_title() for axes in figure.axes]
    assert unchanged == [True] * 4 + [False] * 2 + [True] * 2
    assert [len(axes.get_lines()) for axes in figure.axes] == [3] * 4 + [6] * 2 + [3] * 2


def test_every_follower_looks_the_same_in_all_panels_and_in_the_legend() -> None:
    figure = figure_of("responses")
    shown = [(line.get_color(), line.get_linestyle()) for line in figure.legends[0].get_lines()[:4]]
    assert shown == [(look.colour, look.style) for look in (looks.LEADER, looks.BEFORE, looks.AFTER, looks.FLOOR)]
    for whole, error, near in zip(figure.axes[::3], figure.axes[1::3], figure.axes[2::3], strict=True):
        for axes, expected in ((whole, shown), (error, shown[1:]), (near, shown)):
            lines = axes.get_lines()[: len(expected)]
            assert [(line.get_color(), line.get_linestyle()) for line in lines] == expected


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


def test_convergence_marks_the_last_improvement() -> None:
    figure = figure_of("convergence")
    for axes in figure.axes:
        curve, last = axes.get_lines()
        at = float(x_of(last)[0])
        assert x_of(curve)[int(np.argmin(y_of(curve)))] == at
        assert f"after {at:,.0f} evaluations" in axes.get_title()
        assert axes.get_yscale() == "log"


def test_a_folder_that_cannot_be_made_is_refused(tmp_path: Path) -> None:
    (tmp_path / "file").write_text("")
    with pytest.raises(UserError, match="cannot be written"):
        pictures.draw_sets(tmp_path / "file" / "sets.png", controllers("before_tuning"), controllers("table_9"))


@pytest.mark.slow
def test_a_tuning_gets_all_its_pictures_and_an_unfinished_one_those_there_are(tmp_path: Path) -> None:
    time, leader, followers = motion()
    open_ones = plt.get_fignums()
    before, after, floor = followers.values()
    held_out = SimpleNamespace(
        name="human-like reaches",
        time_s=time,
        leader=leader,
        angles_before=before.angles,
        angles_after=after.angles,
        mse_before=before.mse,
        mse_after=after.mse,
        floor=floor,
    )
    outcome = SimpleNamespace(
        model=SimpleNamespace(arm=SimpleNamespace(joints_in_use=(0, 1, 2, 3))),
        method="paper",
        strategy="mf",
        before=controllers("before_tuning"),
        after=controllers("table_10"),
        held_out=(held_out,),
        curves=(SimpleNamespace(evaluations=(10, 20), cost=(2.0, 1.0)),) * 4,
    )
    drawn = draw(cast(TuningResult, outcome), tmp_path / "new" / "folder")
    assert [path.name for path in drawn] == ["sets.png", "responses_human_like_reaches.png", "convergence.png"]
    assert all(path.read_bytes().startswith(b"\x89PNG") for path in drawn)
    outcome.held_out, outcome.curves = (), ()
    (again,) = draw(cast(TuningResult, outcome), tmp_path)
    assert again.name == "sets.png"
    assert again.read_bytes() == drawn[0].read_bytes(), "the same numbers give the same bytes"
    assert sorted(path.name for path in tmp_path.iterdir()) == ["new", "sets.png"]
    assert plt.get_fignums() == open_ones


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


def test_the_lowest_panel_of_each_column_has_its_axis() -> None:
    costs = [(np.arange(10, 310, 10), 1.0 / np.arange(10, 310, 10))] * 4
    figure = pictures.plot_convergence(costs, "Convergence", pictures.cost_words("default"), (0, 1, 3))
    assert [axes.get_xlabel() for axes in figure.axes] == ["", "evaluations", "evaluations"]
    figure.canvas.draw()
    assert figure.axes[1].xaxis.get_major_ticks()[0].label1.get_visible()


def test_an_error_of_an_unused_joint_is_not_spoken_of() -> None:
    time, leader, followers = motion()
    still = {
        name: replace(one, angles=np.hstack([leader[:, :1], one.angles[:, 1:]])) for name, one in followers.items()
    }
    figure = pictures.plot_responses(time, leader, still, "Response", (0,))
    assert not any("beyond" in text.get_text() for text in figure.legends[0].get_texts())
