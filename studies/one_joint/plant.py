"""One joint as a row of numbers, what is known of a rig beforehand, and the space of what is searched.

Motor, friction and gear are the arm's (docs/arm.md); the quantities searched and their units are those of
greywhale.identify. To these come what a foreign rig may have: load friction, delays, a constant pull.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np
import one_joint_native

from greywhale.base.types import Floats
from greywhale.identify.space import KINDS as ARM_KINDS
from greywhale.identify.space import TEETH_S, Kind, ranges

COLUMNS = (
    *("link_inertia", "weight", "hanging", "pull"),
    *("torque_per_volt", "inertia", "damping", "coulomb", "breakaway", "stribeck_velocity"),
    *("half_gap", "stiffness", "mesh_damping", "drag", "stop_min", "stop_max"),
    *("load_friction", "delay", "leader_delay"),
)
assert len(COLUMNS) == one_joint_native.COLUMNS
_COLUMN = {name: index for index, name in enumerate(COLUMNS)}
STOP = 1e3  # rad, where no stop is known
TEETH_BEND = 1e-2  # rad, of teeth of unknown stiffness at the motor's stall torque

SHARED = ("alpha", "inertia", "damping", "coulomb", "breakaway", "stribeck", "gap")


def _number(unit: str, means: str, start: float, low: float, high: float, step: float) -> Kind:
    """A quantity that is searched as it is."""
    plain = ARM_KINDS["gap"]
    return replace(plain, unit=unit, means=means, logarithmic=False, start=start, low=low, high=high, step=step)


KINDS = {
    **{name: ARM_KINDS[name] for name in SHARED},
    "breakaway": replace(ARM_KINDS["breakaway"], high=5.0),
    "load_friction": _number("", "friction as a share of the torque that the gear passes on", 0.1, 0.0, 1.5, 2e-3),
    "delay": _number("s", "from a reading to its voltage", 2e-3, 0.0, 0.15, 2e-4),
    "leader_delay": _number("s", "from the leader to the controller", 2e-3, 0.0, 0.25, 2e-4),
    "hanging": _number("rad", "angle at which the link hangs", 0.0, -0.3, 0.3, 1e-3),
    "pull": _number("", "constant pull, as a share of what the supply can pull", 0.0, -1.0, 1.0, 1e-3),
}
# How far a quantity may well be from what is published or usual: one standard deviation of the searched number.
DOUBTS = {
    **dict.fromkeys(("alpha", "inertia", "damping", "coulomb", "breakaway", "stribeck"), 1.0),
    "load_friction": 0.3,
    "delay": 0.02,
    "leader_delay": 0.02,
    "hanging": 0.02,
    "pull": 0.05,
    "gap": 0.01,
}


@dataclass(frozen=True)
class Rig:
    """What is published of a rig. alpha, inertia and damping: the white box, in volts per N m, rad/s² and rad/s.

    Where neither gravity nor a known torque acts, volts and torques cannot be told apart: leave `alpha` at 1 then.
    """

    name: str
    supply: float  # V
    inertia: float
    damping: float
    alpha: float = 1.0
    link_inertia: float = 0.0  # kg m²
    weight: float = 0.0  # N m, gravity a quarter turn from hanging
    loaded: bool = False  # a known torque acts on the link
    zero_known: bool = False  # the link hangs at angle 0
    window_s: float = 0.5  # how long logged voltages alone say where a joint goes

    @property
    def alpha_searched(self) -> bool:
        return self.weight > 0.0 or self.loaded or self.link_inertia > 0.0


@dataclass(frozen=True)
class JointSpace:
    """Vectors of some quantities of one joint; logarithms where they are positive and of unknown size."""

    rig: Rig
    names: tuple[str, ...]

    @classmethod
    def of(cls, rig: Rig, names: Sequence[str]) -> JointSpace:
        return cls(rig, tuple(name for name in names if name != "alpha" or rig.alpha_searched))

    def __len__(self) -> int:
        return len(self.names)

    def kind(self, index: int) -> Kind:
        return KINDS[self.names[index]]

    @property
    def steps(self) -> Floats:
        return np.array([self.kind(index).step for index in range(len(self))])

    @property
    def doubts(self) -> Floats:
        return np.array([DOUBTS[name] for name in self.names])

    def start(self) -> Floats:
        return np.array([self.kind(n).to_search(self._usual(name)) for n, name in enumerate(self.names)])

    def bounds(self) -> tuple[Floats, Floats]:
        return ranges([self.kind(index) for index in range(len(self))], self.start())

    def values(self, x: Floats) -> dict[str, float]:
        """In physical units."""
        return {name: self.kind(n).from_search(float(x[n])) for n, name in enumerate(self.names)}

    def translate(self, x: Floats, source: JointSpace) -> Floats:
        """A vector of another space in this one; what that one does not have starts as usual."""
        known = dict(zip(source.names, x, strict=True))
        start = self.start()
        return np.array([known.get(name, start[index]) for index, name in enumerate(self.names)])

    def plants(self, points: Floats) -> Floats:
        """Plants (rows, 19) of searched points (rows)."""
        found = {
            name: np.exp(points[:, n]) if self.kind(n).logarithmic else points[:, n]
            for n, name in enumerate(self.names)
        }
        return plants(self.rig, found, len(points))

    def _usual(self, name: str) -> float:
        known = {"alpha": self.rig.alpha, "inertia": self.rig.inertia, "damping": self.rig.damping}
        # As a share of the supply, so that it fits rigs of any size.
        known["coulomb"] = 0.03 * self.rig.supply
        return known.get(name, KINDS[name].start)


def plants(rig: Rig, found: dict[str, Floats], count: int = 1) -> Floats:
    """Plants (rows, 19) with the given quantities, in identification's units; what is not given is not there."""
    rows = np.zeros((count, len(COLUMNS)))

    def put(name: str, values: Floats | float) -> None:
        rows[:, _COLUMN[name]] = values

    torque = 1.0 / found.get("alpha", np.full(count, rig.alpha))
    coulomb = found.get("coulomb", np.zeros(count)) * torque
    put("link_inertia", rig.link_inertia)
    put("weight", rig.weight)
    put("hanging", found.get("hanging", 0.0))
    put("pull", found.get("pull", 0.0) * rig.supply * torque)
    put("torque_per_volt", torque)
    put("inertia", found.get("inertia", rig.inertia) * torque)
    put("damping", found.get("damping", rig.damping) * torque)
    put("coulomb", coulomb)
    put("breakaway", coulomb * (1.0 + found.get("breakaway", 0.0)))
    put("stribeck_velocity", found.get("stribeck", 0.1))
    put("stop_min", -STOP)
    put("stop_max", STOP)
    for name in ("load_friction", "delay", "leader_delay"):
        put(name, found.get(name, 0.0))
    if "gap" in found:
        stiffness = torque * rig.supply / TEETH_BEND
        put("half_gap", found["gap"])
        put("stiffness", stiffness)
        put("mesh_damping", stiffness * TEETH_S)
    return rows
