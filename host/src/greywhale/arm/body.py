"""The links' rigid-body equations for many states at once (sim/arm/rigid_body.h; docs/arm.md has the formulas)."""

from __future__ import annotations

from dataclasses import dataclass, field

import numpy as np

from greywhale import _native
from greywhale.arm.plants import PLANT_COLUMNS
from greywhale.base.types import Floats

# The links' constants are the columns before those of the joints.
_COLUMNS = next(n for n, name in enumerate(PLANT_COLUMNS) if name.startswith("joint"))


@dataclass(frozen=True)
class Body:
    """The constants of the links, (11,), as the first columns of a plant have them (kg m², and N m for gravity)."""

    constants: Floats = field(repr=False)

    @classmethod
    def of(cls, plant: Floats) -> Body:
        """Of a plant (columns,)."""
        return cls(np.ascontiguousarray(plant[:_COLUMNS]))

    def mass_matrix(self, q: Floats) -> Floats:
        """(n, 4, 4) kg m² at angles (n, 4) rad."""
        return _native.rigid_body_mass_matrix(self.constants, q)

    def bias(self, q: Floats, v: Floats) -> Floats:
        """(n, 4) N m: the torque that holds zero acceleration at angles and speeds (n, 4)."""
        return _native.rigid_body_bias(self.constants, q, v)

    def torque(self, q: Floats, v: Floats, a: Floats) -> Floats:
        """(n, 4) N m that the links take for accelerations (n, 4) rad/s²."""
        needed: Floats = np.einsum("nij,nj->ni", self.mass_matrix(q), a) + self.bias(q, v)
        return needed
