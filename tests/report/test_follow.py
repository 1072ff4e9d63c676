"""The picture: the same logs give the same bytes, and what is drawn is what was measured."""

from __future__ import annotations

from pathlib import Path

import matplotlib.pyplot as plt
import numpy as np
import pytest

from greywhale.errors import UserError
from greywhale.files.log import Log
from greywhale.files.log.layout import Origin
from greywhale.report import Trace, draw_following, follow, trace


def log(gain: float, seed: int = 1) -> Log:
    time = np.arange(0, 4, 0.01)
    leader = np.column_stack([np.sin(time + joint) for joint in range(4)])
    state = np.where(time < 1, "soft_start", "following")
    noise = np.random.default_rng(seed).normal(0, 0.001, leader.shape)
    return Log("x.csv", Origin(), time, leader + noise, gain * leader, 0 * leader, state, 0, True)


@pytest.mark.slow
@pytest.mark.parametrize("ending", [".png", ".svg", ".pdf"])
def test_the_same_logs_give_the_same_bytes(tmp_path: Path, ending: str) -> None:
    for name in ("a", "b"):
        draw_following(tmp_path / (name + ending), [trace(log(0.8), "before"), trace(log(0.95), "after")], "Title")
    first, second = ((tmp_path / (name + ending)).read_bytes() for name in ("a", "b"))
    assert first == second
    assert len(first) > 10_000
    assert sorted(path.name for path in tmp_path.iterdir()) == ["a" + ending, "b" + ending]


def test_only_the_measured_part_is_drawn_and_starts_at_zero() -> None:
    one = trace(log(0.8), "before")
    assert one.time[0] == 0.0
    assert len(one.time) == 300
    assert one.mse[0] == pytest.approx(np.mean((one.leader[:, 0] - one.follower[:, 0]) ** 2))


def labels(traces: list[Trace]) -> list[str]:
    figure = follow.plot_following(traces, "Title")
    try:
        return [text.get_text() for text in figure.legends[0].get_texts()]
    finally:
        plt.close(figure)


def test_leaders_of_the_same_motion_are_one_line_and_others_two() -> None:
    before, after = trace(log(0.8), "before"), trace(log(0.95, seed=2), "after")
    assert labels([before, after]) == ["leader", "follower, before", "follower, after"]
    other = Trace("other", before.time, before.leader + 0.2, before.follower, before.mse)
    assert labels([before, other]) == ["leader, before", "leader, other", "follower, before", "follower, other"]


def test_axes_have_units_and_titles_their_figures() -> None:
    figure = follow.plot_following([trace(log(0.8), "before")], "A title")
    try:
        axes = figure.get_axes()
        assert len(axes) == 8
        assert {one.get_ylabel() for one in axes} == {"angle [rad]", "error [rad]"}
        assert {one.get_xlabel() for one in axes[1::2]} == {"time [s]"}
        assert "Joint 3, wrist roll" in axes[6].get_title()
        assert figure.get_suptitle() == "A title"
    finally:
        plt.close(figure)


@pytest.mark.parametrize("size", [0.0008, 0.02, 0.4])
def test_no_label_is_cut_off_or_runs_into_the_next_panel(size: float) -> None:
    # Reaches of a real log, and errors from those of a follower at rest to those of a step: the finer, the wider.
    time = np.arange(0, 20, 0.01)
    leader = np.column_stack([reach * np.sin(time + reach) - 0.1 for reach in (1.0, 0.65, 0.8, 1.2)])
    error = size * np.column_stack([np.sin(3 * time + joint) for joint in range(4)])
    with follow.set_style():
        figure = follow.plot_following([Trace("log", time, leader, leader - error, (0.1,) * 4)], "A title")
        try:
            renderer = figure.canvas.get_renderer()  # type: ignore[attr-defined]
            figure.draw(renderer)
            axes = figure.get_axes()
            ends = {0.0, *(one.get_window_extent(renderer).x1 for one in axes)}
            for one in axes:
                panel, label = one.get_window_extent(renderer), one.yaxis.label.get_window_extent(renderer)
                assert label.x0 >= max(end for end in ends if end <= panel.x0) + 4, one.get_title()
        finally:
            plt.close(figure)


def test_bad_requests_leave_no_file(tmp_path: Path) -> None:
    one = trace(log(0.8), "x")
    with pytest.raises(UserError, match=r"pictures end in \.png, \.svg, \.pdf"):
        draw_following(tmp_path / "picture.gif", [one], "")
    with pytest.raises(UserError, match="1 to 4 logs, not 5"):
        draw_following(tmp_path / "picture.png", [one] * 5, "")
    with pytest.raises(UserError, match=r"none/picture\.png: cannot be written: no such file"):
        draw_following(tmp_path / "none" / "picture.png", [one], "")
    assert list(tmp_path.iterdir()) == []
