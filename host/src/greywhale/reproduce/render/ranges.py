"""Keeps what belongs together in one line."""

from __future__ import annotations

import re

LONGEST = 24  # letters


def keep_ranges(text: str) -> str:
    """A line may break before a range such as (0.1 to 0.2), not inside of it."""
    return re.sub(rf"\([^()]{{1,{LONGEST}}}\)", lambda found: found.group().replace(" ", "\xa0"), text)
