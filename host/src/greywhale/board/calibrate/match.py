"""An arm file whose potentiometers are those that a board is calibrated for."""

from __future__ import annotations

from typing import Any

from greywhale.arm import ArmParameters
from greywhale.board.pots import COUNT14_PER_COUNT, FULL_SCALE
from greywhale.protocol.joints import require_same
from greywhale.protocol.table import ParameterTable

WHOLE = COUNT14_PER_COUNT * FULL_SCALE


def with_board_pots(arm: ArmParameters, table: ParameterTable) -> ArmParameters:
    """A copy of the arm with the tracks, middles and directions by which the board's table reads angles.

    Raises UserError where arm and board do not use the same joints.
    """
    require_same("the arm file", arm.joints_in_use, "the board", table.joints_in_use)
    data = arm.model_dump()
    for side in ("leader", "follower"):
        for joint, pot in enumerate(data[f"{side}_pots"]["joint"]):
            if table[f"{side}{joint}.scale"] != 0:
                pot.update(_pot(table, f"{side}{joint}"))
    return ArmParameters.model_validate(data, strict=False)


def _pot(table: ParameterTable, name: str) -> dict[str, Any]:
    scale = table.physical(f"{name}.scale")
    middle = (WHOLE / 2.0 - table[f"{name}.zero"]) * scale
    return {"track": abs(scale) * WHOLE, "centre": middle, "direction": 1 if scale > 0.0 else -1}
