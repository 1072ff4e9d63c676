"""Arms that could have made the logs: the identified one, and others drawn from its covariance.

A controller that is to work on the real arm must work on all of them.
"""

from __future__ import annotations

from typing import Any

import numpy as np

from greywhale.arm import ArmParameters
from greywhale.arm.plants import PLANT_COLUMNS, check_plants, column
from greywhale.base.errors import BadUsage, UserError
from greywhale.base.types import Floats
from greywhale.identify.space import KINDS, Parameter, Space
from greywhale.loop import plant_row
from greywhale.protocol.firmware import JOINTS

EVERY = 3  # a rival takes the place of one draw in so many


def sampled_plants(arm: ArmParameters, count: int, seed: int = 0) -> Floats:
    """Plants (count, columns) of an identified arm: row 0 is the estimate itself, the others are drawn with `seed`.

    The searched numbers are drawn from a normal distribution with the covariance of [identification], and kept within
    their ranges. Row n does not depend on `count`. A zero angle is drawn too, but it belongs to the potentiometer and
    is in no column of a plant. Raises UserError (2) where `count` is below 1, (1) where the arm file holds no
    covariance.

    Where [identification] has rivals, models of other structures that predict nearly as well, every third row is one of
    them.
    """
    if count < 1:
        raise BadUsage(f"count of sampled plants is {count}, but it must be at least 1.")
    estimate = plant_row(arm)[None]
    if count == 1:
        return estimate
    plants: Floats = np.concatenate([estimate, draw_plants(*read_search(arm), count - 1, seed)])
    rivals = _read_rivals(arm)
    for number, row in enumerate(range(EVERY, count, EVERY) if len(rivals) else ()):
        plants[row] = rivals[number % len(rivals)]
    return plants


def loosen_gears(arm: ArmParameters, deviations: float) -> Floats:
    """The plant (columns,) of an identified arm with wider gaps and softer teeth, by so many standard deviations.

    A joint without teeth gets the loosest ones that any rival gives it. Without a covariance nothing says by how much,
    and it is the estimate.
    """
    if "covariance" not in (arm.identification or {}):
        return plant_row(arm)
    space, x, covariance = read_search(arm)
    looser = np.array([deviations if one.kind in ("gap", "teeth") else 0.0 for one in space.parameters])
    loose: Floats = space.plants((x + looser * np.sqrt(np.diag(covariance)))[None])[0]
    rivals = _read_rivals(arm)
    for joint in range(JOINTS):
        gap, stiffness, damping = (column(name, joint) for name in ("half_gap", "stiffness", "mesh_damping"))
        toothed = rivals[rivals[:, stiffness] > 0.0]
        if loose[stiffness] == 0.0 and len(toothed):
            loose[gap] = toothed[:, gap].max()
            loose[[stiffness, damping]] = toothed[:, [stiffness, damping]].min(axis=0)
    return loose


def draw_plants(space: Space, x: Floats, covariance: Floats, count: int, seed: int = 0) -> Floats:
    """Plants (count, columns) drawn around the point `x` of a search, with its covariance."""
    scale = np.sqrt(np.diag(covariance))
    # A root that is the same on every computer: eigenvectors have free signs, a Cholesky factor does not.
    root = np.linalg.cholesky(covariance / np.outer(scale, scale) + 1e-9 * np.eye(len(x))) * scale[:, None]
    draws = np.einsum("nk,jk->nj", np.random.default_rng(seed).standard_normal((count, len(x))), root)
    low, high = _ranges(space)
    # The estimate may itself lie at the end of its range.
    return space.plants(np.clip(x + draws, np.minimum(low, x), np.maximum(high, x)))


def _read_rivals(arm: ArmParameters) -> Floats:
    tables: list[dict[str, Any]] = (arm.identification or {}).get("rival", [])
    rows = [np.array(table.get("plant", []), dtype=np.float64) for table in tables]
    if any(row.shape != (len(PLANT_COLUMNS),) for row in rows):
        raise UserError(
            f"{arm.name}: a rival of [identification] has no plant of {len(PLANT_COLUMNS)} numbers; identify again."
        )
    return check_plants(np.array(rows)) if rows else np.zeros((0, len(PLANT_COLUMNS)))


def read_search(arm: ArmParameters) -> tuple[Space, Floats, Floats]:
    """The search that [identification] states: space, point (n,) and covariance (n, n) in searched numbers.

    Raises UserError where it states none, or names an unknown number.
    """
    facts = arm.identification
    if facts is None or "covariance" not in facts:
        raise UserError(
            f"{arm.name}: there is no [identification] with a covariance, so it does not say how uncertain it is; "
            "use a model.toml of greywhale identify (method default)."
        )
    tables: list[dict[str, Any]] = facts.get("parameter", [])
    covariance = np.array(facts["covariance"], dtype=np.float64)
    parameters = tuple(_parameter(arm, str(table.get("name"))) for table in tables)
    if covariance.shape != (len(parameters), len(parameters)) or not np.isfinite(covariance).all():
        raise UserError(
            f"{arm.name}: [identification] covariance has the shape {covariance.shape}, but there are "
            f"{len(parameters)} parameter tables; identify again."
        )
    x = [KINDS[one.kind].to_search(float(table["value"])) for one, table in zip(parameters, tables, strict=True)]
    return Space(arm, parameters, plant_row(arm)), np.array(x), covariance


def _parameter(arm: ArmParameters, name: str) -> Parameter:
    try:
        return Parameter.from_name(name)
    except KeyError:
        raise UserError(
            f"{arm.name}: [identification] names the parameter {name!r}, which greywhale does not know; identify again."
        ) from None


def _ranges(space: Space) -> tuple[Floats, Floats]:
    """The search's own limits where they have a physical meaning: shares and gaps are never negative."""
    kinds = [space.kind(index) for index in range(len(space))]
    low = np.array([-np.inf if kind.logarithmic else kind.low for kind in kinds])
    high = np.array([np.inf if kind.logarithmic else kind.high for kind in kinds])
    return low, high
