"""The pictures of a tuning: what is drawn is what was given, nothing overlaps, the same numbers give the same bytes."""

from __future__ import annotations

from pathlib import Path
from types import SimpleNamespace
from typing import cast

import matplotlib.pyplot as plt
import numpy as np
import pytest
from matplotlib.figure import Figure
from matplotlib.lines import Line2D
from matplotlib.text import Text
from matplotlib.transforms import BboxBase

from greywhale.errors import UserError
from greywhale.files.controller import load
from greywhale.files.paper_tables import paper_table
from greywhale.loop import controller_row
from greywhale.trajectory import multi_steps
from greywhale.tune.outcome import Outcome
from greywhale.tune.report import pictures
from greywhale.tune.report.pictures import Controllers, Floats, Response


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


def figure_of(name: str) -> Figure:
    with pictures.set_style():
        if name == "sets":
            return pictures.plot_sets(controllers("before_tuning"), controllers("table_10"))
        if name == "responses":
            return pictures.plot_responses(*motion(), "Response to multi-steps")
        evaluations = np.arange(10, 310, 10)
        costs = [np.maximum(scale / evaluations, 1.2e-3 * scale) for scale in (1e-3, 1.0, 123456.0, 7e5)]
        return pictures.plot_convergence([(evaluations, cost) for cost in costs], "Convergence")


@pytest.mark.slow
@pytest.mark.parametrize("name", ["sets", "responses", "convergence"])
def test_no_text_runs_into_another_or_over_the_edge(name: str) -> None:
    figure = figure_of(name)
    try:
        renderer = figure.canvas.get_renderer()  # type: ignore[attr-defined]
        figure.draw(renderer)
        texts = [one for one in figure.findobj() if isinstance(one, Text) and one.get_visible()]
        boxes = [(text.get_text(), text.get_window_extent(renderer)) for text in texts if text.get_text().strip()]
        width, height = figure.canvas.get_width_height()
        shown = [(text, box) for text, box in boxes if box.width > 0 and not _is_unused_tick(figure, text, box)]
        assert len(shown) > 20
        for place, (text, box) in enumerate(shown):
            assert min(box.x0, box.y0, width - box.x1, height - box.y1) >= 0, f"{text} is cut off"
            for other, other_box in shown[place + 1 :]:
                assert not box.overlaps(other_box), f"{text} and {other} overlap"
    finally:
        plt.close("all")


def _is_unused_tick(figure: Figure, text: str, box: BboxBase) -> bool:
    """Matplotlib keeps labels of ticks that lie outside of their axis, or are switched off, without drawing them."""
    renderer = figure.canvas.get_renderer()  # type: ignore[attr-defined]
    drawn = set()
    for axes in figure.axes:
        for axis in (axes.xaxis, axes.yaxis):
            low, high = sorted(axis.get_view_interval())
            for tick in axis.get_major_ticks() + axis.get_minor_ticks():
                label = tick.label1
                inside = low - 1e-9 <= tick.get_loc() <= high + 1e-9
                if label.get_text() == text and label.get_window_extent(renderer).bounds == box.bounds:
                    drawn.add(inside and label.get_visible())
    return bool(drawn) and not any(drawn)


def test_the_sets_have_their_corners_where_the_board_has_them() -> None:
    figure = figure_of("sets")
    try:
        error, change = figure.axes[0], figure.axes[1]
        assert "Joint 0, base yaw: error" in error.get_title()
        lines = {(line.get_linestyle(), index % 3): line for index, line in enumerate(error.get_lines())}
        np.testing.assert_allclose(x_of(lines["--", 1]), [-0.3, 0.0, 0.3], atol=1e-4)
        np.testing.assert_allclose(x_of(lines["-", 0]), [-1.0, -0.0785, 0.0], atol=1e-4)
        np.testing.assert_allclose(y_of(lines["-", 2]), [0.0, 1.0, 1.0])
        np.testing.assert_allclose(x_of(change.get_lines()[5]), [0.0, 1.0, 1.0], atol=1e-4)
    finally:
        plt.close("all")


def test_responses_show_every_follower_its_error_and_its_figure() -> None:
    time, _, followers = motion()
    figure = figure_of("responses")
    try:
        assert len(figure.axes) == 12
        whole, error, near = figure.axes[:3]
        assert len(whole.get_lines()) == 4
        np.testing.assert_array_equal(y_of(whole.get_lines()[2]), followers["after tuning"].angles[:, 0])
        assert f"after {followers['after tuning'].mse[0]:#.3g}" in whole.get_title(loc="left")
        assert (whole.get_ylabel(), error.get_ylabel()) == ("angle [rad]", "error [rad]")
        first, last = near.get_xlim()
        assert first < 11.0 < last, "the largest of the steps, 1.2 rad, comes at 11 s"
        assert [text.get_text() for text in figure.legends[0].get_texts()] == ["leader", *followers]
        assert time[0] == whole.get_xlim()[0]
    finally:
        plt.close("all")


def test_convergence_marks_the_last_improvement() -> None:
    figure = figure_of("convergence")
    try:
        for axes in figure.axes:
            curve, last = axes.get_lines()
            at = float(x_of(last)[0])
            assert x_of(curve)[int(np.argmin(y_of(curve)))] == at
            assert f"after {at:,.0f} evaluations" in axes.get_title()
            assert axes.get_yscale() == "log"
    finally:
        plt.close("all")


@pytest.mark.slow
def test_the_same_numbers_give_the_same_bytes(tmp_path: Path) -> None:
    for name in ("a", "b"):
        pictures.draw_sets(tmp_path / name / "sets.png", controllers("before_tuning"), controllers("table_9"))
    assert (tmp_path / "a" / "sets.png").read_bytes() == (tmp_path / "b" / "sets.png").read_bytes()
    assert [path.name for path in (tmp_path / "a").iterdir()] == ["sets.png"]
    assert plt.get_fignums() == []


def test_a_folder_that_cannot_be_made_is_refused(tmp_path: Path) -> None:
    (tmp_path / "file").write_text("")
    with pytest.raises(UserError, match="cannot be written"):
        pictures.draw_sets(tmp_path / "file" / "sets.png", controllers("before_tuning"), controllers("table_9"))


@pytest.mark.slow
def test_a_tuning_gets_all_its_pictures_and_an_unfinished_one_those_there_are(tmp_path: Path) -> None:
    time, leader, followers = motion()
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
        method="paper",
        strategy="mf",
        before=controllers("before_tuning"),
        after=controllers("table_10"),
        held_out=(held_out,),
        curves=(SimpleNamespace(evaluations=(10, 20), cost=(2.0, 1.0)),) * 4,
    )
    drawn = pictures.draw(cast(Outcome, outcome), tmp_path / "new" / "folder")
    assert [path.name for path in drawn] == ["sets.png", "responses_human_like_reaches.png", "convergence.png"]
    assert all(path.read_bytes().startswith(b"\x89PNG") for path in drawn)
    outcome.held_out, outcome.curves = (), ()
    assert [path.name for path in pictures.draw(cast(Outcome, outcome), tmp_path)] == ["sets.png"]
