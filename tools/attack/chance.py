"""The share of damage whose CRC is right by chance, and counts that chance does not explain."""

from __future__ import annotations

CRC_MATCH = 2.0**-16  # the share of damage without order whose CRC of 16 bits is right


def too_many(found: int, expected: float) -> int:
    """By how much a count is above what chance explains: 0 but for once in some 10^9 times."""
    return max(0, found - int(expected + 6 * expected**0.5 + 6))
