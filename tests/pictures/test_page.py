"""The page: legends fit, what is cut off is marked, a figure gives the same bytes; short names tell files apart."""

from __future__ import annotations

from pathlib import Path

import matplotlib.pyplot as plt
import numpy as np
import pytest
from matplotlib.figure import Figure
from matplotlib.lines import Line2D

from greywhale.base.errors import UserError
from greywhale.pictures import looks
from greywhale.pictures.kinds import KINDS, kind_of
from greywhale.pictures.names import distinct_names
from greywhale.pictures.page import (
    WIDE,
    leave,
    legend_below,
    mark_beyond,
    png,
    save,
    save_into,
    style,
)


def simple() -> Figure:
    figure, axes = plt.subplots(figsize=(WIDE / 2.0, 2.0))
    figure.subplots_adjust(**leave(figure, 0.6, 0.1, 0.45, 0.1))
    axes.plot([0.0, 1.0], [1.0, 2.0], **looks.BEFORE.line)
    axes.set_xlabel("time [s]")
    axes.set_ylabel("angle [rad]")
    return figure


@pytest.mark.parametrize("words", [["one"], ["quite a long name of a log", "another that is as long"] * 4])
def test_a_legend_takes_the_rows_that_it_needs(words: list[str]) -> None:
    with style():
        figure = plt.figure(figsize=(WIDE, 3.0))
        height = legend_below(figure, [Line2D([], [], **looks.LEADER.line)] * len(words), words)
        assert len(figure.legends) == 1
        box = figure.legends[0].get_window_extent()
        assert box.x0 >= 0.0
        assert box.width <= WIDE * figure.dpi
        assert height == pytest.approx(box.height / figure.dpi)
        assert (height > 0.3) == (len(words) > 1)


def test_what_leaves_a_panel_is_marked_in_its_colour_and_nothing_else_is() -> None:
    x = np.arange(0.0, 10.0, 0.01)
    high, low = np.where(np.abs(x - 3.0) < 0.2, 1.2, 0.1), np.where(np.abs(x - 7.0) < 0.2, -0.5, 0.1)
    _, axes = plt.subplots()
    for y, look in ((high, looks.BEFORE), (low, looks.AFTER)):
        axes.plot(x, y, **look.line)
    assert mark_beyond(axes, 0.2, [(x, high, looks.BEFORE), (x, low, looks.AFTER)]) == pytest.approx(1.2)
    assert axes.get_ylim() == (-0.2, 0.2)
    marks = {(line.get_marker(), line.get_color()): list(line.get_xydata()) for line in axes.get_lines()[2:]}  # type: ignore[arg-type]
    assert {key: len(places) for key, places in marks.items() if places} == {
        ("^", looks.BEFORE.colour): 1,
        ("v", looks.AFTER.colour): 1,
    }
    assert marks["^", looks.BEFORE.colour][0] == pytest.approx([2.8, 0.2], abs=0.02)


@pytest.mark.parametrize("kind", KINDS)
def test_the_same_figure_gives_the_same_file(kind: str, tmp_path: Path) -> None:
    with style():
        files = [save(simple(), tmp_path / f"{name}{kind}").read_bytes() for name in "ab"]
        assert files[0] == files[1]
        assert png(simple()) == png(simple())
    assert plt.get_fignums() == []


def test_what_cannot_be_written_is_refused_and_leaves_nothing(tmp_path: Path) -> None:
    with pytest.raises(UserError, match=r"pictures end in \.png, \.svg, \.pdf"):
        kind_of(tmp_path / "picture.gif")
    with pytest.raises(UserError, match="cannot be written"):
        save(simple(), tmp_path / "none" / "picture.png")
    (tmp_path / "file").write_text("")
    with pytest.raises(UserError, match="cannot be made"):
        save_into(simple(), tmp_path / "file", "picture.png")
    assert plt.get_fignums() == []
    assert [path.name for path in tmp_path.iterdir()] == ["file"]


@pytest.mark.parametrize(
    ("files", "names"),
    [
        (["run/before.csv"], ["before"]),
        (["before.csv", "after.csv"], ["before", "after"]),
        (["one/log.csv", "two/log.csv", "two/other.csv"], ["one/log", "two/log", "other"]),
        (["/x/one/run/log.csv", "/x/two/run/log.csv"], ["one/…/log", "two/…/log"]),
        (["log.csv", "log.txt"], ["log.csv", "log.txt"]),
        (["log.csv", "./log.csv"], ["log, 1", "log, 2"]),
        (["x" * 100 + ".csv"], ["x" * 15 + "…" + "x" * 14]),
    ],
)
def test_names_tell_files_apart(files: list[str], names: list[str]) -> None:
    assert distinct_names(files) == names
