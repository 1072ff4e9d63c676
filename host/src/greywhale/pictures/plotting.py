"""Matplotlib, imported here and nowhere else: without a display, and without a `matplotlibrc` of the current folder.

Such a file may be a stranger's, and can have TeX run. Matplotlib reads it while it is imported.
"""
# ruff: noqa: E402

from __future__ import annotations

import os
import sys
from pathlib import Path


def _import_matplotlib() -> None:
    """Import it in a folder that is ours."""
    here = os.open(".", getattr(os, "O_PATH", os.O_RDONLY))  # the folder's name may have gone
    try:
        os.chdir(Path(__file__).parent)
        __import__("matplotlib")
    finally:
        os.fchdir(here)
        os.close(here)


if "matplotlib" not in sys.modules:
    _import_matplotlib()

import matplotlib

matplotlib.use("Agg")
import matplotlib.pyplot as plt
from matplotlib.artist import Artist
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.lines import Line2D
from matplotlib.patches import FancyBboxPatch
from matplotlib.ticker import FuncFormatter, LogLocator, NullFormatter
from matplotlib.transforms import offset_copy

__all__ = [
    "Artist",
    "Axes",
    "FancyBboxPatch",
    "Figure",
    "FuncFormatter",
    "Line2D",
    "LogLocator",
    "NullFormatter",
    "matplotlib",
    "offset_copy",
    "plt",
]
