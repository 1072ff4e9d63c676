"""A folder with a stranger's files, each of which leaves its name when Python imports it."""

from __future__ import annotations

import sys
from collections.abc import Collection
from pathlib import Path

# What greywhale and its libraries import beside Python's own modules, and what Python and reportlab look for.
OTHERS = (
    *("click", "cma", "greywhale_paper", "greywhale_sim", "matplotlib", "numpy", "pydantic", "reportlab", "scipy"),
    *("serial", "sitecustomize", "usercustomize", "reportlab_settings"),
)
# A picture with these would have TeX run, or its paper red; the last line is no UTF-8, which ends Matplotlib's import.
MATPLOTLIBRC = b"text.usetex: True\nfigure.facecolor: red\nsavefig.facecolor: red\n# \xff\n"


def plant(folder: Path, spare: Collection[str] = ()) -> None:
    """Put them there, but none with these names. They import nothing themselves."""
    note = f"open({str(folder / 'ran')!r}, 'a').write(__name__ + '\\n')\n"
    for name in {*sys.stdlib_module_names, *OTHERS} - {*spare}:
        (folder / f"{name}.py").write_text(note, encoding="utf-8")
    (folder / "matplotlibrc").write_bytes(MATPLOTLIBRC)


def ran(folder: Path) -> set[str]:
    """The names of those that were imported."""
    noted = folder / "ran"
    return set(noted.read_text(encoding="utf-8").split()) if noted.exists() else set()
