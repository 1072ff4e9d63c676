"""Matplotlib, imported here and nowhere else: without a display, and without a `matplotlibrc` of the current folder.

Such a file may be a stranger's, and can have TeX run. Matplotlib reads it while it is imported.
"""

from __future__ import annotations

import sys
from pathlib import Path

from greywhale.base import system

if "matplotlib" not in sys.modules:
    with system.inside(Path(__file__).parent):  # a folder that is ours
        __import__("matplotlib")

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
