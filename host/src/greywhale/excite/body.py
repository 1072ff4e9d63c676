"""The arm's rigid-body equations for many states at once, in numpy: mass matrix and bias torque as in docs/arm.md."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
import numpy.typing as npt

Floats = npt.NDArray[np.float64]


@dataclass(frozen=True)
class Body:
    """The eleven constants of the links, as in the first columns of a plant (kg m², and N m for gravity)."""

    yaw: float
    ixx1: float
    iyy1: float
    ixx23: float
    iyy23: float
    izz23: float
    ixx3: float
    izz1: float
    coupling: float
    gravity1: float
    gravity2: float

    @classmethod
    def of(cls, plant: Floats) -> Body:
        """The constants of a plant (60,)."""
        return cls(*(float(value) for value in plant[:11]))

    def mass_matrix(self, q: Floats) -> Floats:
        """(n, 4, 4) kg m² at angles (n, 4) rad."""
        s1, c1, phi = np.sin(q[:, 1]), np.cos(q[:, 1]), q[:, 1] + q[:, 2]
        s, c, c2 = np.sin(phi), np.cos(phi), np.cos(q[:, 2])
        m = np.zeros((len(q), 4, 4))
        m[:, 0, 0] = (
            self.yaw
            + self.ixx1 * s1**2
            + self.iyy1 * c1**2
            + self.ixx23 * s**2
            + self.iyy23 * c**2
            + 2.0 * self.coupling * c1 * c
        )
        m[:, 0, 3] = m[:, 3, 0] = self.ixx3 * s
        m[:, 3, 3] = self.ixx3
        m[:, 2, 2] = self.izz23
        m[:, 1, 2] = m[:, 2, 1] = self.izz23 + self.coupling * c2
        m[:, 1, 1] = self.izz1 + self.izz23 + 2.0 * self.coupling * c2
        return m

    def bias(self, q: Floats, v: Floats) -> Floats:
        """(n, 4) N m: the torque that holds zero acceleration at angles and speeds (n, 4)."""
        s1, c1, s2, phi = np.sin(q[:, 1]), np.cos(q[:, 1]), np.sin(q[:, 2]), q[:, 1] + q[:, 2]
        s, c = np.sin(phi), np.cos(phi)
        v0, v1, v2, v3 = v.T
        across = (self.ixx23 - self.iyy23) * 2.0 * s * c
        d1 = (self.ixx1 - self.iyy1) * 2.0 * s1 * c1 + across - 2.0 * self.coupling * (s1 * c + c1 * s)
        d2 = across - 2.0 * self.coupling * c1 * s
        roll = self.ixx3 * c
        gyroscopic, wrist, gravity2 = roll * v0 * v3, self.coupling * s2, self.gravity2 * c
        return np.column_stack(
            [
                (d1 * v1 + d2 * v2) * v0 + roll * (v1 + v2) * v3,
                -0.5 * d1 * v0**2 - wrist * v2 * (2.0 * v1 + v2) - gyroscopic + self.gravity1 * c1 + gravity2,
                -0.5 * d2 * v0**2 + wrist * v1**2 - gyroscopic + gravity2,
                roll * v0 * (v1 + v2),
            ]
        )

    def torque(self, q: Floats, v: Floats, a: Floats) -> Floats:
        """(n, 4) N m that the links take for accelerations (n, 4) rad/s²."""
        needed: Floats = np.einsum("nij,nj->ni", self.mass_matrix(q), a) + self.bias(q, v)
        return needed
