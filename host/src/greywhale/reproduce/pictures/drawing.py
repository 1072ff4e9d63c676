"""What all figures share: style, colours, and the way into a PNG that is the same for the same numbers."""

from __future__ import annotations

import io
from collections.abc import Iterator
from contextlib import contextmanager

import matplotlib

matplotlib.use("Agg")
import matplotlib.pyplot as plt
from matplotlib.figure import Figure

from greywhale.arm.parameters import JOINT_NAMES

# Okabe and Ito's palette: told apart by colour-blind readers too. The leader and what was recorded are dark.
DARK, ORANGE, BLUE, GREEN, PURPLE = "#222222", "#D55E00", "#0072B2", "#009E73", "#CC79A7"
DPI = 130
TITLES = tuple(f"Joint {joint}, {name}" for joint, name in enumerate(JOINT_NAMES))


@contextmanager
def styled() -> Iterator[None]:
    """Matplotlib's settings for the report."""
    with matplotlib.rc_context({"font.size": 9, "axes.grid": True, "grid.alpha": 0.3, "axes.axisbelow": True}):
        yield


def png(figure: Figure) -> bytes:
    """The figure as a PNG; it is closed."""
    file = io.BytesIO()
    try:
        figure.savefig(file, format="png", dpi=DPI, metadata={"Software": None})
    finally:
        plt.close(figure)
    return file.getvalue()
