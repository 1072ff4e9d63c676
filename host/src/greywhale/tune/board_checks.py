"""Refuses a board that is not calibrated for the arm, before anything moves it."""

from __future__ import annotations

from greywhale.arm import ArmParameters
from greywhale.arm.parameters import JOINT_NAMES
from greywhale.base.errors import UserError
from greywhale.protocol.joints import require_same
from greywhale.protocol.table import ParameterTable
from greywhale.tune.limits import TUNING_LIMITS, ModelLimits
from greywhale.tune.model_checks import CONVERTER_SPAN, MATCH, doubt_other_board


def refuse_uncalibrated(arm: ArmParameters, table: ParameterTable, limits: ModelLimits = TUNING_LIMITS.model) -> None:
    """Refuse a board whose table contradicts the arm file: joints, supply, a potentiometer's slope or zero angle."""
    require_same("the arm file", arm.joints_in_use, "the board", table.joints_in_use)
    for doubt in doubt_other_board(arm, None, table, limits):
        raise UserError(f"the board does not fit the arm file ({arm.name}): {doubt.reason}; {doubt.remedy}.")
    usual = ParameterTable.defaults()
    for joint, pot in enumerate(arm.follower_pots.joint):
        name = f"follower{joint}.zero"
        if joint not in table.joints_in_use:
            continue
        middle = (CONVERTER_SPAN / 2 - table[name]) * table.physical(f"follower{joint}.scale")
        if abs(middle - pot.centre) > limits.same_zero_rad:
            state = "was never calibrated" if table[name] == usual[name] else "is calibrated for another arm"
            raise UserError(
                f"joint {joint} ({JOINT_NAMES[joint]}) {state}: its potentiometer's middle is {pot.centre:.2f} rad "
                f"by the arm file, but the board's {name} makes it {middle:.2f} rad; correct the one that is wrong "
                f"({MATCH})."
            )
