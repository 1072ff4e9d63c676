"""The place of the paper's controllers (shared/fuzzy_tables): inside an installed package, else in the checkout.

They have names, as the arms that come with greywhale do: whatever reads a controller.toml takes these too.
"""

from __future__ import annotations

from pathlib import Path

_PACKAGE = Path(__file__).resolve().parents[1]
_INSTALLED = _PACKAGE / "data" / "fuzzy_tables"
_CHECKOUT = _PACKAGE.parents[2] / "shared" / "fuzzy_tables"
NAMES = ("before_tuning", "table_10", "table_8", "table_9")


def controller_names() -> list[str]:
    """The controllers that come with greywhale: the paper's before tuning, and what its Tables 8 to 10 found."""
    return list(NAMES)


def controller_path(source: str | Path) -> Path:
    """The file of one of `controller_names()`; any other name is a file's own."""
    return paper_table(str(source)) if str(source) in NAMES else Path(source)


def paper_table(name: str) -> Path:
    """The controller.toml of one of the paper's tables, by its name in `NAMES`."""
    folder = _INSTALLED if _INSTALLED.is_dir() else _CHECKOUT
    return folder / f"{name}.toml"
