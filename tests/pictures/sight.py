"""Finds what a person would see wrong in a picture, by its renderer."""

from __future__ import annotations

import re
from collections.abc import Iterator

from matplotlib.axes import Axes
from matplotlib.axis import Axis
from matplotlib.colors import to_hex
from matplotlib.figure import Figure
from matplotlib.lines import Line2D
from matplotlib.text import Text
from matplotlib.transforms import BboxBase

# No letter on paper is smaller; nothing comes nearer to an edge (points).
SMALLEST_PT, EDGE_PT = 6.5, 1.5
# Axes of these words need no unit.
WITHOUT_UNIT = {"iteration", "evaluations", "membership", "mean rank (1 is best)", "fuzzy output", "normalised"}


def faults(figure: Figure) -> list[str]:
    """One sentence for each fault; an empty list for a good picture. It must be made in the pictures' style."""
    renderer = figure.canvas.get_renderer()  # type: ignore[attr-defined]
    figure.draw(renderer)
    return [*_texts(figure), *_axes(figure), *_legends(figure)]


def _texts(figure: Figure) -> Iterator[str]:
    renderer = figure.canvas.get_renderer()  # type: ignore[attr-defined]
    unused = {id(text) for text in _unused_ticks(figure)}
    texts = [one for one in figure.findobj() if isinstance(one, Text) and one.get_visible() and one.get_text().strip()]
    # The box of the words alone, without the arrow of an annotation.
    boxes = [(one, Text.get_window_extent(one, renderer)) for one in texts if id(one) not in unused]
    shown = [(one, box) for one, box in boxes if box.width > 0]
    panels = [(axes, axes.get_window_extent(renderer)) for axes in figure.axes if axes.axison]
    width, height = figure.canvas.get_width_height()
    near = EDGE_PT * figure.dpi / 72.0
    for place, (one, box) in enumerate(shown):
        said = repr(one.get_text())
        size = float(one.get_fontsize())
        if size < SMALLEST_PT:
            yield f"{said} has letters of {size:g} pt"
        if min(box.x0, box.y0, width - box.x1, height - box.y1) < near:
            yield f"{said} touches the edge or is cut off"
        for other, other_box in shown[place + 1 :]:
            if _is_over(box, other_box):
                yield f"{said} and {other.get_text()!r} overlap"
        for axes, panel in panels:
            if one.axes is not axes and _is_over(box, panel):
                yield f"{said} lies over a panel that is not its own"


def _is_over(one: BboxBase, other: BboxBase) -> bool:
    """More than by a hair: letters do not fill their box."""
    wide = min(one.x1, other.x1) - max(one.x0, other.x0)
    high = min(one.y1, other.y1) - max(one.y0, other.y0)
    return wide > 1.0 and high > 1.0


def _unused_ticks(figure: Figure) -> Iterator[Text]:
    """Matplotlib keeps labels of ticks outside of their axis without drawing them."""
    for axes in figure.axes:
        for axis in (axes.xaxis, axes.yaxis):
            low, high = sorted(axis.get_view_interval())
            for tick in (*axis.get_major_ticks(), *axis.get_minor_ticks()):
                if not axes.axison or not low - 1e-9 <= tick.get_loc() <= high + 1e-9:
                    yield from (tick.label1, tick.label2)


def _axes(figure: Figure) -> Iterator[str]:
    common = figure.get_supylabel()
    for number, axes in enumerate(figure.axes):
        if not axes.axison:
            continue
        labels = ((axes.xaxis, _x_label(figure, axes)), (axes.yaxis, _y_label(figure, axes) or common))
        for axis, label in labels:
            words = label.rpartition("\n")[2]
            if not words and _shows_numbers(axis):
                yield f"an axis of panel {number} has no label"
            elif words and words not in WITHOUT_UNIT and not re.search(r"\[.+\]|K_[pd]", words):
                yield f"{words!r} has no unit"


def _shows_numbers(axis: Axis) -> bool:
    labels = [tick.label1 for tick in axis.get_major_ticks() if tick.label1.get_visible()]
    return any(re.fullmatch(r"[-−.\d]+", label.get_text()) for label in labels)


def _x_label(figure: Figure, axes: Axes) -> str:
    """The panel's own, or that of a panel below with which it shares the axis."""
    below = [one for one in figure.axes if one.get_shared_x_axes().joined(one, axes)]
    column = [one for one in below if abs(one.get_position().x0 - axes.get_position().x0) < 1e-6]
    return axes.get_xlabel() or next((one.get_xlabel() for one in column if one.get_xlabel()), "")


def _y_label(figure: Figure, axes: Axes) -> str:
    beside = [one for one in figure.axes if one.get_shared_y_axes().joined(one, axes)]
    row = [one for one in beside if abs(one.get_position().y0 - axes.get_position().y0) < 1e-6]
    return axes.get_ylabel() or next((one.get_ylabel() for one in row if one.get_ylabel()), "")


def _legends(figure: Figure) -> Iterator[str]:
    """A legend's line must be drawn somewhere as it is shown there."""
    legends = [*figure.legends, *(axes.get_legend() for axes in figure.axes if axes.get_legend() is not None)]
    drawn = {_look(line) for axes in figure.axes for line in axes.get_lines() if len(line.get_xydata())}  # type: ignore[arg-type]
    styles = {style for style, _ in drawn}
    for legend in legends:
        assert legend is not None
        for handle, words in zip(legend.legend_handles, legend.get_texts(), strict=True):
            if not isinstance(handle, Line2D) or handle.get_linestyle() == "None":
                continue
            style, colour = _look(handle)
            # Grey stands for a style in any colour.
            if (style, colour) not in drawn and not (colour == "#888888" and style in styles):
                yield f"nothing is drawn as the legend shows {words.get_text()!r}: {style} {colour}"


def _look(line: Line2D) -> tuple[str, str]:
    return str(line.get_linestyle()), to_hex(line.get_color())
