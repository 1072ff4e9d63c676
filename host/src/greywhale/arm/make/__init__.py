"""An arm file from a ruler, a scale and data sheets: questions, link bodies, motors, and what the arm can lift."""

from __future__ import annotations

from greywhale.arm.make.assemble import assemble
from greywhale.arm.summary import Summary, summarise

__all__ = ["Summary", "assemble", "summarise"]
