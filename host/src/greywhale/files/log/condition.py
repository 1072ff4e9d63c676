"""The condition of a log that was read: whether it is as it was recorded, and where samples are missing."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from greywhale.base.errors import counted
from greywhale.files.log.check import Check, compare, rows_stated
from greywhale.files.log.limits import GAPS
from greywhale.files.log.units import doubt_spacing, usual_step

# A sentence names so many gaps one by one.
_MOST_NAMED_GAPS = 3


@dataclass(frozen=True)
class Gap:
    """Samples that are missing in a row, `length_s` after the row at the time `after_s`."""

    after_s: float
    length_s: float
    samples: int


@dataclass(frozen=True)
class Condition:
    """The check's outcome, the gaps, and remarks for whoever uses the log, as sentences that follow its name."""

    check: Check = Check.UNCHECKED
    gaps: tuple[Gap, ...] = ()
    remarks: tuple[str, ...] = ()


def judge_condition(name: str, facts: Mapping[str, str], crc: int, time_s: NDArray[np.float64]) -> Condition:
    """The condition of the log `name`, by its header's facts, the CRC of its rows and their times."""
    check, gaps = compare(facts, name, len(time_s), crc), gaps_in(time_s)
    remarks = {
        Check.WHOLE: (),
        Check.UNCHECKED: (
            "it has no check (an older greywhale, another tool, or a recording that was killed), so nothing "
            "shows whether it is as it was recorded.",
        ),
        Check.SHORTENED: (
            f"only {len(time_s)} of its {rows_stated(facts, name)} rows are there, so nothing shows whether "
            "these are as they were recorded.",
        ),
        Check.CHANGED: ("its check fails: rows or header are not as they were recorded.",),
    }[check]
    odd = () if "every_ticks" in facts else doubt_spacing(time_s)
    return Condition(check, gaps, remarks + odd + ((_describe(gaps),) if gaps else ()))


def gaps_in(time_s: NDArray[np.float64]) -> tuple[Gap, ...]:
    """The gaps, in which more than ten samples in a row are missing, by the usual time between two rows."""
    period = max(usual_step(time_s), GAPS.shortest_s)
    steps = np.diff(time_s)
    # Clocks and decimals round.
    rows = np.flatnonzero(steps > (GAPS.most_missing_samples + 1.5) * period)
    return tuple(
        Gap(round(after, 6), round(length, 6), round(min(length / period, GAPS.most_samples)) - 1)
        for after, length in zip(time_s[rows].tolist(), steps[rows].tolist(), strict=True)
    )


def _describe(gaps: tuple[Gap, ...]) -> str:
    each = [f"{gap.length_s:.7g} s ({counted(gap.samples, 'sample')}) after {gap.after_s:.7g} s" for gap in gaps]
    more = f", and {counted(len(gaps) - _MOST_NAMED_GAPS, 'gap')} more" if len(gaps) > _MOST_NAMED_GAPS else ""
    return f"samples are missing for {', '.join(each[:_MOST_NAMED_GAPS])}{more}; nothing is known of the arm there."
