"""The paper that pictures are drawn for: its width, its letters, legends, marks for what is cut off, and files.

A picture has the size that it has on paper: 17 cm (both columns). The same numbers give the same file, byte for byte:
no display, no date and no random identifier goes into it, and margins are fixed, because the results of a layout solver
differ in the last digits from run to run.
"""

from __future__ import annotations

import contextlib
import io
from collections.abc import Iterator, Mapping, Sequence
from pathlib import Path
from typing import Any

import numpy as np

from greywhale.arm.parameters import JOINT_NAMES
from greywhale.base.errors import UserError
from greywhale.base.formats.whole import make_folder, write_whole
from greywhale.base.types import Floats
from greywhale.pictures.kinds import CHANGING, kind_of
from greywhale.pictures.looks import GREY, Look
from greywhale.pictures.plotting import (
    Artist,
    Axes,
    Figure,
    FuncFormatter,
    Line2D,
    LogLocator,
    NullFormatter,
    matplotlib,
    offset_copy,
    plt,
)

WIDE = 17.0 / 2.54  # inches
DPI, DOCUMENT_DPI = 300, 200  # of files, and of pictures inside a document
LETTERS, SMALL = 8.0, 7.0  # points
JOINTS = tuple(f"Joint {joint}, {name}" for joint, name in enumerate(JOINT_NAMES))
_SETTINGS: dict[Any, Any] = {
    "font.size": LETTERS,
    "axes.titlesize": LETTERS,
    "axes.labelsize": LETTERS,
    "xtick.labelsize": SMALL,
    "ytick.labelsize": SMALL,
    "legend.fontsize": LETTERS,
    "figure.titlesize": 9.5,
    "figure.titleweight": "bold",
    "axes.grid": True,
    "grid.alpha": 0.3,
    "axes.axisbelow": True,
    "axes.linewidth": 0.6,
    "svg.hashsalt": "greywhale",
}
_MARK = 3.5  # points
# Jumps would hide the error that is left after them (rad).
LARGEST_ERROR = 0.2


@contextlib.contextmanager
def style() -> Iterator[None]:
    """Matplotlib's settings for every picture, for as long as the context lasts; those of the user's files rest."""
    with matplotlib.rc_context():
        matplotlib.rcdefaults()
        matplotlib.rcParams.update(_SETTINGS)
        yield


def leave(figure: Figure, left: float, right: float, bottom: float, top: float, **between: float) -> dict[str, float]:
    """Margins in inches as shares of the figure, for `subplots_adjust` and `add_gridspec`."""
    width, height = figure.get_size_inches()
    return {
        "left": left / width,
        "right": 1.0 - right / width,
        "bottom": bottom / height,
        "top": 1.0 - top / height,
        **between,
    }


def headline(figure: Figure, text: str) -> None:
    figure.suptitle(text, y=1.0 - 0.06 / figure.get_size_inches()[1], va="top")


def legend_below(figure: Figure, handles: Sequence[Artist], labels: Sequence[str]) -> float:
    """One legend for all panels at the lower edge, in as many rows as it needs; its height in inches."""
    width = figure.get_size_inches()[0] - 0.1
    for columns in range(len(labels), 0, -1):
        legend = figure.legend(
            handles,
            labels,
            loc="lower center",
            bbox_to_anchor=(0.5, 0.02 / figure.get_size_inches()[1]),
            ncols=columns,
            frameon=False,
            borderaxespad=0.1,
            columnspacing=1.2,
            handlelength=1.7,
            handletextpad=0.5,
        )
        box = legend.get_window_extent(figure.canvas.get_renderer())  # type: ignore[attr-defined]
        if box.width <= width * figure.dpi or columns == 1:
            break
        legend.remove()
    return float(box.height / figure.dpi)


def mark_beyond(axes: Axes, most: float, curves: Sequence[tuple[Floats, Floats, Look]]) -> float:
    """Limit the panel to ±`most` where curves (x, y, look) leave that; triangles in their colours mark these places.

    The largest absolute value of them all; up to `most`, nothing was done.
    """
    largest = max(float(np.max(np.abs(y), initial=0.0)) for _, y, _ in curves)
    if not largest > most:
        return largest
    low, high = axes.get_ylim()
    axes.set_ylim(max(low, -most), min(high, most))
    first, last = axes.get_xlim()
    for side, marker in ((1.0, "^"), (-1.0, "v")):
        marked = [(_peaks(x, side * y, most, last - first), look) for x, y, look in curves]
        for number, (at, look) in enumerate((at, look) for at, look in marked if at):
            # Those of one moment stand below each other, inside the panel.
            down = -side * _MARK * (number + 0.6)
            inwards = offset_copy(axes.transData, axes.get_figure(root=True), y=down, units="points")
            drawn: dict[str, Any] = {"color": look.colour, "markersize": _MARK, "clip_on": False, "zorder": 5}
            axes.plot(at, [side * most] * len(at), marker, transform=inwards, **drawn)
    return largest


def _peaks(x: Floats, y: Floats, most: float, width: float) -> list[float]:
    """The places of the highest points above `most`: one of each stretch, some of a stretch that is long."""
    beyond = np.flatnonzero(y > most)
    stretches: list[list[int]] = []
    for at in beyond:
        here = stretches[-1] if stretches else []
        if here and x[at] - x[here[-1]] <= 0.02 * width and x[at] - x[here[0]] <= 0.08 * width:
            here.append(int(at))
        else:
            stretches.append([int(at)])
    return [float(x[one[int(np.argmax(y[one]))]]) for one in stretches]


def label_responses(figure: Figure, lines: Mapping[str, Line2D], largest: float) -> float:
    """The legend of responses, by the words of its lines, with those triangles if an error was so large; its height in
    inches.
    """
    if largest > LARGEST_ERROR:
        mark = Line2D([], [], marker="^", linestyle="none", color=GREY, markersize=_MARK)
        lines = {**lines, f"beyond ±{LARGEST_ERROR:g} rad (up to {largest:.2g})": mark}
    return legend_below(figure, list(lines.values()), list(lines))


def make_logarithmic(axes: Axes) -> None:
    """A logarithmic y axis for what is drawn in the panel, with plain numbers."""
    axes.set_yscale("log")
    low, high = axes.get_ylim()
    few = np.log10(high / low) < 3.0  # from here on such an axis has powers of ten alone
    axes.yaxis.set_major_locator(LogLocator(subs=(1.0, 2.0, 5.0) if few else (1.0,)))
    axes.yaxis.set_major_formatter(FuncFormatter(lambda value, _: f"{value:g}"))
    axes.yaxis.set_minor_formatter(NullFormatter())


def save(figure: Figure, path: Path) -> Path:
    """Write the picture, whole or not at all, its kind by its ending; the figure is closed."""
    try:
        kind = kind_of(path)
        metadata: dict[str, Any] = {CHANGING[kind]: None}
        write_whole(path, lambda file: figure.savefig(file, format=kind[1:], dpi=DPI, metadata=metadata))
    finally:
        plt.close(figure)
    return path


def save_into(figure: Figure, folder: Path, name: str) -> Path:
    """`save` into a folder that is made first where it is not there."""
    try:
        make_folder(folder)
    except UserError:
        plt.close(figure)
        raise
    return save(figure, folder / name)


def png(figure: Figure) -> bytes:
    """The figure as a PNG to be put into a document; it is closed."""
    file = io.BytesIO()
    try:
        figure.savefig(file, format="png", dpi=DOCUMENT_DPI, metadata={CHANGING[".png"]: None})
    finally:
        plt.close(figure)
    return file.getvalue()
