"""One finding of an examination: what was looked at, how it is, and what to do."""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import dataclass
from enum import StrEnum


class Verdict(StrEnum):
    """A grade: `note` is worth knowing, `bad` must be mended before an arm moves."""

    GOOD = "good"
    NOTE = "note"
    BAD = "bad"


@dataclass(frozen=True)
class Finding:
    """`says` is a sentence; `remedy`, another one, is empty where nothing has to be done."""

    check: str  # what was looked at
    verdict: Verdict
    says: str  # what was found
    remedy: str = ""  # what to do; empty where nothing


def worst(findings: Iterable[Finding]) -> Verdict:
    """The gravest verdict; good where there is nothing."""
    order = list(Verdict)
    return max((one.verdict for one in findings), key=order.index, default=Verdict.GOOD)
