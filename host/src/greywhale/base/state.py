"""The folder for what greywhale remembers from one day to another, such as earlier calibrations of a board."""

from __future__ import annotations

import os
from pathlib import Path

from greywhale.base import system
from greywhale.base.errors import UserError

# Names another folder: for tests, and where the user has no home that can be written.
VARIABLE = "GREYWHALE_STATE_DIR"


def state_directory() -> Path:
    """The folder, which need not be there yet; a UserError where the user has no home."""
    given = os.environ.get(VARIABLE)
    if given:
        return Path(given)
    try:
        return system.state_folder() / "greywhale"
    except RuntimeError:
        raise UserError(f"this user has no home folder to remember anything in; name one in {VARIABLE}.") from None
