"""The place of the paper's controllers (shared/fuzzy_tables): inside an installed package, else in the checkout."""

from __future__ import annotations

from pathlib import Path

_PACKAGE = Path(__file__).resolve().parents[1]
_INSTALLED = _PACKAGE / "data" / "fuzzy_tables"
_CHECKOUT = _PACKAGE.parents[2] / "shared" / "fuzzy_tables"


def paper_table(name: str) -> Path:
    """The controller.toml of one of the paper's tables: "before_tuning", "table_8", "table_9" or "table_10"."""
    folder = _INSTALLED if _INSTALLED.is_dir() else _CHECKOUT
    return folder / f"{name}.toml"
