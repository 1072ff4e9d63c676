"""The limits of a law that becomes a header: how large its table may be, and how weak its weakest rule."""

from __future__ import annotations

from dataclasses import dataclass

from greywhale.base.limits import BY_JUDGEMENT, BY_THE_FIRMWARE, limit


@dataclass(frozen=True)
class HeaderLimits:
    """The laws that a header takes."""

    most_sets: int = limit(7, "sets", "of a variable: beyond it the table does not fit a person's head", BY_JUDGEMENT)
    least_height: float = limit(
        1 / 256, "", "a weaker answer is a hole: heights have 16 bits, and the area divides by it", BY_THE_FIRMWARE
    )


HEADER_LIMITS = HeaderLimits()
