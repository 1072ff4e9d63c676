"""Candidates as rows of numbers: controllers as the firmware stores them, plants as the arm's equations use them."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
import numpy.typing as npt

from greywhale import _native
from greywhale.arm import ArmParameters
from greywhale.errors import UserError
from greywhale.files.controller import Controller
from greywhale.protocol import schema

JOINTS = 4

# One joint's controller, raw as in the parameter table: sets q14, gains q16, mV.
CONTROLLER_COLUMNS = ("ne_c", "ze_a", "ze_c", "pe_b", "nce_c", "zce_a", "zce_c", "pce_b", "kp", "kd", "ki", "ku_mv")

_BODY = ("yaw", "ixx1", "iyy1", "ixx23", "iyy23", "izz23", "ixx3", "izz1", "coupling", "gravity1", "gravity2")
_JOINT = (
    *("torque_per_volt", "inertia", "damping", "coulomb", "breakaway", "stribeck_velocity"),
    *("half_gap", "stiffness", "mesh_damping", "drag", "stop_min", "stop_max"),
)

# A plant in SI units at the joints' output shafts: docs/closed_loop.md says what each is.
PLANT_COLUMNS = (*_BODY, *(f"joint{joint}.{name}" for joint in range(JOINTS) for name in _JOINT), "supply")
assert len(PLANT_COLUMNS) == _native.PLANT_COLUMNS

Controllers = npt.NDArray[np.int32]
Plants = npt.NDArray[np.float64]

_POSITIVE = (
    *("yaw", "ixx1", "iyy1", "ixx23", "iyy23", "izz23", "ixx3", "izz1", "supply"),
    "inertia",
    "stribeck_velocity",
)
_NOT_NEGATIVE = ("coulomb", "damping", "half_gap", "stiffness", "mesh_damping", "drag")


def _columns_named(names: Sequence[str]) -> npt.NDArray[np.intp]:
    return np.array([index for index, column in enumerate(PLANT_COLUMNS) if column.split(".")[-1] in names])


def controller_row(controller: Controller) -> Controllers:
    """A controller.toml as the firmware will store it: int32 (4, 12)."""
    raw = controller.raw_values()
    return controllers_of([raw.get(index, value) for index, value in enumerate(schema.DEFAULTS)])


def default_controller() -> Controllers:
    """The firmware's own defaults: int32 (4, 12)."""
    return controllers_of(schema.DEFAULTS)


def controllers_of(values: Sequence[int]) -> Controllers:
    """The controllers of a whole parameter table (raw, in index order): int32 (4, 12)."""
    index = schema.PARAMETER_BY_NAME
    rows = [[values[index[f"joint{joint}.{key}"].index] for key in CONTROLLER_COLUMNS] for joint in range(JOINTS)]
    return np.array(rows, dtype=np.int32)


def plant_row(parameters: ArmParameters) -> Plants:
    """An arm as one row: float64 (60,), in the order of PLANT_COLUMNS."""
    return np.asarray(_native.plant_row(parameters.native()), dtype=np.float64)


def check_controllers(controllers: Controllers) -> Controllers:
    """One row or many, every one of which the firmware would accept; with the first axis added where it was missing."""
    _check_type("controllers", controllers, np.int32)
    rows = controllers[None] if controllers.ndim == 2 else controllers
    if rows.ndim != 3 or rows.shape[1:] != (JOINTS, len(CONTROLLER_COLUMNS)):
        raise UserError(f"controllers have the shape {controllers.shape}, but (n, 4, 12) or (4, 12) is needed.")
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


def check_plants(plants: Plants) -> Plants:
    """One row or many with numbers that an arm can have; with the first axis added where it was missing."""
    _check_type("plants", plants, np.float64)
    rows = plants[None] if plants.ndim == 1 else plants
    if rows.ndim != 2 or rows.shape[1] != len(PLANT_COLUMNS):
        raise UserError(f"plants have the shape {plants.shape}, but (n, 60) or (60,) is needed.")
    _refuse(rows, ~np.isfinite(rows), "it must be a finite number")
    named = np.array([column.split(".")[-1] for column in PLANT_COLUMNS])
    _refuse(rows, np.isin(named, _POSITIVE) & (rows <= 0.0), "it must be above 0")
    _refuse(rows, np.isin(named, _NOT_NEGATIVE) & (rows < 0.0), "it must not be negative")
    for name, below, need in (
        ("breakaway", "coulomb", "it must not be below coulomb"),
        ("stop_max", "stop_min", "it must not be below stop_min"),
    ):
        columns = _columns_named([name])
        mask = np.zeros(rows.shape, dtype=bool)
        mask[:, columns] = rows[:, columns] < rows[:, _columns_named([below])]
        _refuse(rows, mask, need)
    columns = _columns_named(["stiffness"])
    mask = np.zeros(rows.shape, dtype=bool)
    mask[:, columns] = (rows[:, columns] == 0.0) & (rows[:, _columns_named(["half_gap"])] > 0.0)
    _refuse(rows, mask, "a gear with a gap needs teeth with some")
    return np.ascontiguousarray(rows)


def _refuse(rows: Plants, wrong: npt.NDArray[np.bool_], need: str) -> None:
    found = np.argwhere(wrong)
    if len(found):
        row, column = (int(index) for index in found[0])
        raise UserError(f"plants[{row}]: {PLANT_COLUMNS[column]} is {rows[row, column]:g}, but {need}.")


def _check_type(name: str, array: object, wanted: type) -> None:
    if not isinstance(array, np.ndarray):
        raise UserError(f"{name} must be a numpy array of {np.dtype(wanted)}, not a {type(array).__name__}.")
    if array.dtype != wanted:
        raise UserError(
            f"{name} are of type {array.dtype}, but {np.dtype(wanted)} is needed; nothing is converted unasked."
        )
