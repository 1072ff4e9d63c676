"""All parts of the attacks, in the order of the page."""

from __future__ import annotations

from tools.attack.part import Part
from tools.attack.parts import cuts, faults, fuzz, hands, lies, link

PARTS: tuple[Part, ...] = (
    faults.PART,
    lies.PART,
    hands.PART,
    link.PART,
    fuzz.PART,
    cuts.PART,
)
