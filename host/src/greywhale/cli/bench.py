"""Finds the bench, which is a package of its own and may be missing."""

from __future__ import annotations

import importlib
from typing import Any

from greywhale.base.errors import UserError


def need_bench(module: str) -> Any:
    """Import a module that needs greywhale_sim; without that package, one sentence with the remedy."""
    try:
        return importlib.import_module(module)
    except ImportError as error:
        if (error.name or "").split(".")[0] != "greywhale_sim":
            raise
        raise UserError(
            "the simulated bench is a package of its own, greywhale-sim, and is not installed; "
            "run `pip install greywhale-sim`, or `make setup` in a checkout."
        ) from None
