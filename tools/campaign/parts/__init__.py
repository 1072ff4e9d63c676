"""All parts of the campaign, in the order of the page."""

from __future__ import annotations

from tools.campaign.part import Part
from tools.campaign.parts import kills

PARTS: tuple[Part, ...] = (kills.PART,)
