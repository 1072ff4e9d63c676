"""Table 6, the rule base: RULES[e][ce] is the output set, OUTPUTS where each stands as a singleton.

AND is min, aggregation is max.
"""

from __future__ import annotations

from typing import Final

RULES: Final[dict[str, dict[str, str]]] = {
    "NE": {"NCE": "NU", "ZCE": "NU", "PCE": "ZU"},
    "ZE": {"NCE": "NU", "ZCE": "ZU", "PCE": "PU"},
    "PE": {"NCE": "ZU", "ZCE": "PU", "PCE": "PU"},
}
OUTPUTS: Final[dict[str, int]] = {"NU": -1, "ZU": 0, "PU": 1}
