"""Arms as rows of numbers, in the form that the arm's equations use: SI units at the joints' output shafts.

Columns go by name, with the constants of docs/arm.md:

- of the links ``yaw`` Iyy0, ``ixx1``, ``iyy1`` Iyy1 + P1, ``ixx23`` X, ``iyy23`` Y, ``izz23`` e, ``ixx3``, ``izz1``
  Izz1 + P1, ``coupling`` h, ``gravity1`` g S1, ``gravity2`` g S2;
- of a joint, at its output shaft, ``torque_per_volt``, ``inertia``, ``damping``, ``resistance``, ``coulomb``,
  ``breakaway``, ``stribeck_velocity``, ``load_friction``, ``creep_velocity``, ``half_gap``, ``stiffness``,
  ``mesh_damping``, ``drag``, ``stop_min``, ``stop_max``, ``pot_play``, ``pot_lag``, ``lost_up``, ``lost_down``.
"""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
import numpy.typing as npt

from greywhale import _native
from greywhale.arm.parameters import ArmParameters
from greywhale.base.errors import UserError
from greywhale.protocol.firmware import JOINTS

Plants = npt.NDArray[np.float64]

# In the order of the native code: constants of the links, numbers of each joint, the supply.
PLANT_COLUMNS: tuple[str, ...] = _native.PLANT_COLUMN_NAMES

COLUMNS = len(PLANT_COLUMNS)

_INDEX = {name: index for index, name in enumerate(PLANT_COLUMNS)}
_POSITIVE = (
    *("yaw", "ixx1", "iyy1", "ixx23", "iyy23", "izz23", "ixx3", "izz1", "supply"),
    "inertia",
    "resistance",
    "stribeck_velocity",
)
_NOT_NEGATIVE = (
    *("coulomb", "damping", "load_friction", "creep_velocity", "half_gap", "stiffness", "mesh_damping", "drag"),
    *("pot_play", "pot_lag", "lost_up", "lost_down", "supply_resistance"),
)


def column(name: str, joint: int | None = None) -> int:
    """The place of a column: column("supply"), column("half_gap", joint=2)."""
    return _INDEX[name if joint is None else f"joint{joint}.{name}"]


def columns(name: str) -> list[int]:
    """The places of a column of all four joints: plants[:, columns("half_gap")]."""
    return [column(name, joint) for joint in range(JOINTS)]


def plant_row(parameters: ArmParameters) -> Plants:
    """An arm as one row: float64 (columns,), in the order of PLANT_COLUMNS."""
    return np.asarray(_native.plant_row(parameters.native()), dtype=np.float64)


def rigid_joints(plants: Plants) -> npt.NDArray[np.bool_]:
    """True for each joint that is not in use, (4,) or (n, 4): one without room between its stops."""
    return plants[..., columns("stop_max")] <= plants[..., columns("stop_min")]


def check_plants(plants: Plants) -> Plants:
    """Check one row or many with numbers that an arm can have; the first axis is added where it was missing."""
    check_type("plants", plants, np.float64)
    rows = plants[None] if plants.ndim == 1 else plants
    if rows.ndim != 2 or rows.shape[1] != len(PLANT_COLUMNS):
        raise UserError(f"plants have the shape {plants.shape}, but (n, {COLUMNS}) or ({COLUMNS},) is needed.")
    _refuse(rows, ~np.isfinite(rows), "it must be a finite number")
    named = np.array([name.split(".")[-1] for name in PLANT_COLUMNS])
    _refuse(rows, np.isin(named, _POSITIVE) & (rows <= 0.0), "it must be above 0")
    _refuse(rows, np.isin(named, _NOT_NEGATIVE) & (rows < 0.0), "it must not be negative")
    for name, below in (("breakaway", "coulomb"), ("stop_max", "stop_min")):
        lower = rows[:, columns(name)] < rows[:, columns(below)]
        _refuse(rows, _mark_column(rows, name, lower), f"it must not be below {below}")
    lost = rows[:, columns("lost_up")] + rows[:, columns("lost_down")] > 2.0 * rows[:, [column("supply")]]
    _refuse(rows, _mark_column(rows, "lost_up", lost), "with lost_down it must not be above twice the supply")
    toothless = (rows[:, columns("stiffness")] == 0.0) & (rows[:, columns("half_gap")] > 0.0)
    _refuse(rows, _mark_column(rows, "stiffness", toothless), "a gear with a gap needs teeth with some")
    return np.ascontiguousarray(rows)


def check_type(name: str, array: object, wanted: type) -> None:
    """Raise UserError unless the argument of this name is a numpy array of the wanted type."""
    if not isinstance(array, np.ndarray):
        raise UserError(f"{name} must be a numpy array of {np.dtype(wanted)}, not a {type(array).__name__}.")
    if array.dtype != wanted:
        raise UserError(
            f"{name} are of type {array.dtype}, but {np.dtype(wanted)} is needed; nothing is converted unasked."
        )


def _mark_column(rows: Plants, name: str, wrong: npt.NDArray[np.bool_]) -> npt.NDArray[np.bool_]:
    """A mask over all columns, from a mask over the four joints of one column."""
    mask = np.zeros(rows.shape, dtype=bool)
    mask[:, columns(name)] = wrong
    return mask


def _refuse(rows: Plants, wrong: npt.NDArray[np.bool_], need: str) -> None:
    found: Sequence[Sequence[int]] = np.argwhere(wrong).tolist()
    if found:
        row, place = found[0]
        raise UserError(f"plants[{row}]: {PLANT_COLUMNS[place]} is {rows[row, place]:g}, but {need}.")
