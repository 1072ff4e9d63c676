"""Numbers with units as people write them: `140`, `14 cm`, `5 kg cm`; and the range that a number must lie in."""

from __future__ import annotations

import math
import re
from collections.abc import Mapping
from dataclasses import dataclass, field

_NUMBER = re.compile(r"([-+]?(?:\d+\.?\d*|\.\d+)(?:[eE][-+]?\d+)?)(.*)", re.DOTALL)


@dataclass(frozen=True)
class Unit:
    """A unit that is asked for, and what its other spellings count in it; `key` ends a key of an answers file."""

    name: str
    key: str
    others: Mapping[str, float] = field(default_factory=dict)


MM = Unit("mm", "_mm", {"cm": 10.0, "m": 1000.0, "in": 25.4})
GRAM = Unit("g", "_g", {"kg": 1000.0})
VOLT = Unit("V", "_v", {"mv": 0.001})
AMPERE = Unit("A", "_a", {"ma": 0.001})
NEWTON_METRE = Unit("N m", "_nm", {"ncm": 0.01, "mnm": 0.001, "kgcm": 0.0980665, "kgfcm": 0.0980665, "ozin": 0.0070616})
RPM = Unit("rpm", "_rpm", {"rad/s": 60.0 / math.tau, "deg/s": 1.0 / 6.0})
DEGREE = Unit("degrees", "_deg", {"deg": 1.0, "degree": 1.0, "°": 1.0, "rad": 180.0 / math.pi})
GRAM_CM2 = Unit("g cm2", "_gcm2", {"gcm²": 1.0, "kgm2": 1e7, "kgm²": 1e7})
PLAIN = Unit("", "")


def read_number(text: str, unit: Unit) -> float:
    """The number in that unit. Raises ValueError with the reason."""
    found = _NUMBER.fullmatch(text.strip())
    if found is None:
        raise ValueError("that is no number")
    number, rest = found.groups()
    written = re.sub(r"[\s·*^-]", "", rest).lower()
    factors = {re.sub(r"\s", "", unit.name).lower(): 1.0, "": 1.0, **unit.others}
    if written not in factors:
        known = ", ".join(one for one in (unit.name, *unit.others) if one) or "none"
        hint = "; write a point, not a comma" if written.startswith(",") else ""
        raise ValueError(f'the unit "{rest.strip()[:20]}" is not known here; there are: {known}{hint}')
    value = float(number) * factors[written]
    if not math.isfinite(value):
        raise ValueError("that is no finite number")
    return value


def shown(value: float, unit: Unit) -> str:
    return f"{value:.4g} {unit.name}".rstrip()
