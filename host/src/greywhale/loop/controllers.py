"""Controllers as rows of numbers, as the firmware stores them: int32 (4, 13), the columns of a parameter table."""

from __future__ import annotations

import numpy as np

from greywhale.arm.plants import check_type
from greywhale.base.errors import UserError
from greywhale.base.types import Controllers
from greywhale.files.controller import Controller
from greywhale.protocol import schema
from greywhale.protocol.firmware import JOINTS
from greywhale.protocol.table import CONTROLLER_COLUMNS, ParameterTable


def controllers_of(table: ParameterTable) -> Controllers:
    """The controllers of a whole parameter table: int32 (4, 13)."""
    return np.array(table.controllers, dtype=np.int32)


def controller_row(controller: Controller) -> Controllers:
    """A controller.toml as the firmware will store it: int32 (4, 13)."""
    return controllers_of(controller.table())


def default_controller() -> Controllers:
    """The firmware's own defaults: int32 (4, 13)."""
    return controllers_of(ParameterTable.defaults())


def check_controllers(controllers: Controllers) -> Controllers:
    """Check one row or many that the firmware must accept; the first axis is added where it was missing."""
    check_type("controllers", controllers, np.int32)
    rows = controllers[None] if controllers.ndim == 2 else controllers
    if rows.ndim != 3 or rows.shape[1:] != (JOINTS, len(CONTROLLER_COLUMNS)):
        raise UserError(f"controllers have the shape {controllers.shape}, but (n, 4, 13) or (4, 13) is needed.")
    parameters = [schema.PARAMETER_BY_NAME[f"joint0.{key}"] for key in CONTROLLER_COLUMNS]
    low = np.array([parameter.minimum for parameter in parameters])
    high = np.array([parameter.maximum for parameter in parameters])
    wrong = np.argwhere((rows < low) | (rows > high))
    if len(wrong):
        row, joint, column = (int(index) for index in wrong[0])
        raise UserError(
            f"controllers[{row}, {joint}]: {CONTROLLER_COLUMNS[column]} is {rows[row, joint, column]}, "
            f"but it must lie within {low[column]}..{high[column]} (raw)."
        )
    return np.ascontiguousarray(rows)
