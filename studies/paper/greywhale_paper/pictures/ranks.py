"""How methods rank: a line each from setting to setting."""

from __future__ import annotations

from collections.abc import Mapping
from itertools import pairwise

from greywhale.pictures import looks
from greywhale.pictures.page import WIDE, leave
from greywhale.pictures.plotting import Axes, Figure, plt

# Methods in a picture: dark and saturated colours first, then the same dashed.
_COLOURS = (looks.BLUE, looks.ORANGE, looks.GREEN, looks.DARK, looks.PURPLE, looks.AMBER, looks.SKY, looks.GREY)
_STYLES = ("-", "--", ":")
_LETTER_IN, _NAME_HIGH_IN = 0.066, 0.15  # room for the methods' names, inches


def plot_ranks(ranks: Mapping[str, Mapping[str, float]], title: str) -> Figure:
    """Setting -> method -> mean rank; the names stand at the end, in a figure of pyplot's that the caller closes."""
    across, last = range(len(ranks)), list(ranks.values())[-1]
    figure, axes = plt.subplots(figsize=(WIDE, 0.9 + 0.36 * max(len(last), 6)))
    names_in = 0.3 + _LETTER_IN * max(map(len, last))
    figure.subplots_adjust(**leave(figure, 0.6, names_in, 0.3, 0.32))
    for index, method in enumerate(last):
        colour = _COLOURS[index % len(_COLOURS)]
        style = _STYLES[index // len(_COLOURS) % len(_STYLES)]
        drawn = [rank[method] for rank in ranks.values()]
        axes.plot(across, drawn, "o", linestyle=style, color=colour, linewidth=1.3, markersize=4)
    axes.margins(x=0.06)
    axes.invert_yaxis()
    _name_lines(axes, last, across[-1])
    axes.set_xticks(list(across), list(ranks))
    axes.set_ylabel("mean rank (1 is best)")
    axes.set_title(title)
    return figure


def _name_lines(axes: Axes, ranks: Mapping[str, float], at: float) -> None:
    """Each method's name right of the panel, joined to the end of its line."""
    low, high = sorted(axes.get_ylim())
    height = axes.get_figure().get_size_inches()[1] * axes.get_position().height  # type: ignore[union-attr]
    places = _spread(ranks, (high - low) * _NAME_HIGH_IN / height, high)
    for line, method in zip(axes.get_lines(), ranks, strict=True):
        colour = line.get_color()
        axes.annotate(
            method,
            (at, ranks[method]),
            (1.03, places[method]),
            textcoords=axes.get_yaxis_transform(),
            va="center",
            color=colour,
            arrowprops={"arrowstyle": "-", "color": colour, "linewidth": 0.5, "shrinkA": 1.0, "shrinkB": 3.0},
        )


def _spread(ranks: Mapping[str, float], gap: float, most: float) -> dict[str, float]:
    """Where the names go: beside their lines, but `gap` apart, and none beyond `most`."""
    order = sorted(ranks, key=lambda method: ranks[method])
    places = dict(ranks)
    for above, below in pairwise(order):
        places[below] = max(places[below], places[above] + gap)
    limit = most
    for method in reversed(order):
        places[method] = min(places[method], limit)
        limit = places[method] - gap
    return places
