"""Numbers with units as people write them: `140`, `14 cm`, `5 kg cm`; and the range that a number must lie in."""

from __future__ import annotations

import math
import re
from collections.abc import Mapping
from dataclasses import dataclass, field

_NUMBER = re.compile(r"([-+]?(?:\d+\.?\d*|\.\d+)(?:[eE][-+]?\d+)?)(.*)", re.DOTALL)


@dataclass(frozen=True)
class Unit:
    """A unit that is asked for, and what others count in it."""

    name: str
    others: Mapping[str, float] = field(default_factory=dict)


MM = Unit("mm", {"cm": 10.0, "m": 1000.0, "in": 25.4})
GRAM = Unit("g", {"kg": 1000.0})
VOLT = Unit("V", {"mV": 0.001})
AMPERE = Unit("A", {"mA": 0.001})
NEWTON_METRE = Unit("N m", {"N cm": 0.01, "mN m": 0.001, "kg cm": 0.0980665, "kgf cm": 0.0980665, "oz in": 0.0070616})
RPM = Unit("rpm", {"rad/s": 60.0 / math.tau, "deg/s": 1.0 / 6.0})
DEGREE = Unit("degrees", {"deg": 1.0, "degree": 1.0, "°": 1.0, "rad": 180.0 / math.pi})
GRAM_CM2 = Unit("g cm2", {"g cm²": 1.0, "kg m2": 1e7, "kg m²": 1e7})
PLAIN = Unit("")
# Those of a board's parameters.
MILLIVOLT = Unit("mV", {"V": 1000.0})
MILLISECOND = Unit("ms", {"s": 1000.0})
SECOND = Unit("s", {"ms": 0.001})
RADIAN = Unit("rad", {"deg": math.pi / 180.0, "°": math.pi / 180.0, "mrad": 0.001})
RADIAN_PER_SECOND = Unit("rad/s", {"deg/s": math.pi / 180.0, "°/s": math.pi / 180.0, "rpm": math.tau / 60.0})
_BY_NAME = {unit.name: unit for unit in (MILLIVOLT, VOLT, MILLISECOND, SECOND, RADIAN, RADIAN_PER_SECOND)}


def unit_of(name: str) -> Unit:
    """The unit of this name; one that nobody writes otherwise has no others."""
    return _BY_NAME.get(name, Unit(name))


def read_number(text: str, unit: Unit) -> float:
    """The number in that unit. Raises ValueError with the reason."""
    found = _NUMBER.fullmatch(text.strip())
    if found is None:
        raise ValueError("that is no number")
    number, rest = found.groups()
    written = _plain(rest)
    factors = {_plain(unit.name): 1.0, "": 1.0, **{_plain(other): factor for other, factor in unit.others.items()}}
    if written not in factors:
        known = ", ".join(one for one in (unit.name, *unit.others) if one) or "none"
        hint = "; write a point, not a comma" if written.startswith(",") else ""
        raise ValueError(f'the unit "{rest.strip()[:20]}" is not known here; there are: {known}{hint}')
    value = float(number)
    if factors[written] != 1.0:
        value = float(f"{value * factors[written]:.12g}")  # 2.3 V are 2300 mV, not a hair less
    if not math.isfinite(value):
        raise ValueError("that is no finite number")
    return value


def _plain(name: str) -> str:
    """As it is compared: kg·cm, kg-cm and kg cm alike."""
    return re.sub(r"[\s·*^-]", "", name).lower()


def shown(value: float, unit: Unit) -> str:
    return f"{value:.4g} {unit.name}".rstrip()
