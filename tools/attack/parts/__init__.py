"""All parts of the attacks, in the order of the page."""

from __future__ import annotations

from tools.attack.part import Part
from tools.attack.parts import cuts, eeprom, faults, fuzz, lies, link, soak

PARTS: tuple[Part, ...] = (
    faults.PART,
    lies.PART,
    link.PART,
    fuzz.PART,
    cuts.PART,
    eeprom.PART,
    soak.PART,
)
