"""The searched numbers, per joint: combinations of motor data that motion can show, friction, backlash, zero angle.

A joint's five motor values act through three numbers only: the volts that a torque needs (alpha), an acceleration needs
(inertia) and a speed needs (damping). They are positive and of unknown size, so their logarithms are searched.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass, field
from typing import Self

import numpy as np
from numpy.typing import NDArray

from greywhale.arm import ArmParameters
from greywhale.arm.parameters import PITCH_JOINTS, Tip
from greywhale.arm.plants import column, plant_row
from greywhale.base.types import Floats
from greywhale.protocol.firmware import JOINTS


@dataclass(frozen=True)
class Kind:
    """One quantity of every joint: how it is searched, in which range, and how it is stated."""

    unit: str
    means: str
    logarithmic: bool
    start: float  # where nothing is known
    low: float  # factor of the start where logarithmic, else the value itself
    high: float
    step: float  # of finite differences, in the searched number
    # How far it may be from the user's arm, or from the usual: one standard deviation of the searched number. It weighs
    # as much as one reading, so it decides only what the log leaves open.
    doubt: float

    def to_search(self, value: float) -> float:
        return math.log(value) if self.logarithmic else value

    def from_search(self, number: float) -> float:
        return math.exp(number) if self.logarithmic else number


# Friction at rest and load friction end at a half. Voltages alone are explained as well by more, but such a
# joint sticks in a closed loop where the real one moves (docs/real_data.md).
KINDS = {
    "alpha": Kind("V/(N m)", "voltage a torque needs, R/(N Kt)", True, 0.0, 1 / 30, 30.0, 2e-3, 0.4),
    "inertia": Kind("V s²/rad", "voltage an acceleration needs, R N J/Kt", True, 0.0, 1 / 100, 100.0, 2e-3, 1.0),
    "damping": Kind("V s/rad", "voltage a speed needs, N Kt + N Bm R/Kt", True, 0.0, 1 / 30, 30.0, 2e-3, 1.0),
    "coulomb": Kind("V", "Coulomb friction at the motor", True, 0.3, 1 / 30, 30.0, 2e-3, 1.0),
    "breakaway": Kind(
        "", "excess of friction at rest over sliding friction, a share of it", False, 0.2, 0.0, 0.5, 1e-2, 1.0
    ),
    "stribeck": Kind("rad/s", "speed at which the extra friction at rest has halved", True, 0.1, 0.1, 5.0, 1e-2, 1.0),
    "gap": Kind("rad", "half of the backlash, at the joint", False, 2e-3, 0.0, 0.03, 1e-4, 1e-2),
    "drag": Kind("", "drag of the grease between the teeth, a share of the damping", True, 0.1, 1e-2, 10.0, 1e-2, 1.5),
    "teeth": Kind("rad", "bend of the teeth at the motor's stall torque", True, 1e-2, 3e-2, 1e3, 2e-2, 1.5),
    "ringing": Kind("s", "damping of the teeth, a share of their stiffness", True, 2e-3, 2e-2, 5.0, 2e-2, 1.0),
    "play": Kind("rad", "half of the play between joint and potentiometer", False, 4e-3, 0.0, 0.05, 1e-4, 2e-2),
    "load": Kind("", "friction that the torque passed on adds, a share of it", False, 0.1, 0.0, 0.5, 1e-2, 0.5),
    "creep": Kind("rad/s", "speed at which a joint gives way just below breakaway", False, 5e-3, 0.0, 0.3, 1e-3, 0.05),
    "lag": Kind("s", "time constant of the low-pass behind the potentiometer", False, 5e-4, 0.0, 2e-2, 1e-4, 2e-3),
    "lost": Kind("V", "voltage that the driver keeps, the mean of both directions", False, 0.1, 0.0, 4.0, 1e-2, 0.3),
    "uneven": Kind("V", "half of what it keeps more when it drives up than down", False, 0.0, -1.0, 1.0, 1e-2, 0.3),
    "sag": Kind("ohm", "resistance of supply and cables, shared by all motors", False, 0.1, 0.0, 5.0, 1e-2, 0.5),
    "tip": Kind("kg", "load at the tip", False, 0.0, -0.01, 2.0, 1e-3, 0.2),
    "offset": Kind("rad", "angle at which the potentiometer reads 0", False, 0.0, -0.3, 0.3, 1e-3, 0.1),
}
MOTOR = ("alpha", "inertia", "damping")
GEAR = ("gap", "drag", "teeth", "ringing")  # what short windows tell of a gear
# Joints that feel each other while one of their numbers is varied a little. The pitch joints carry one another. Yaw and
# roll feel the others through their poses only, and each other by a few per cent at most.
COUPLED = ((0,), (1, 2), (3,))
# Quantities of the arm as a whole: their joint is this number.
OF_THE_ARM = ("sag", "tip")
WHOLE_ARM = JOINTS


_JOINT_NUMBERS = {f"joint{number}": number for number in range(JOINTS)} | {"arm": WHOLE_ARM}


@dataclass(frozen=True)
class Parameter:
    """One searched number, of a joint or of the whole arm."""

    joint: int
    kind: str

    @property
    def name(self) -> str:
        return f"arm.{self.kind}" if self.joint == WHOLE_ARM else f"joint{self.joint}.{self.kind}"

    @classmethod
    def from_name(cls, name: str) -> Self:
        """The searched number of a name such as "joint2.coulomb"; KeyError where there is none."""
        joint, _, kind = name.partition(".")
        if kind not in KINDS or (joint == "arm") != (kind in OF_THE_ARM):
            raise KeyError(name)
        return cls(_JOINT_NUMBERS[joint], kind)


@dataclass(frozen=True)
class Space:
    """Vectors of searched numbers for some quantities of some joints; everything else stays as in the user's arm."""

    arm: ArmParameters
    parameters: tuple[Parameter, ...]
    base: Floats = field(repr=False)

    @classmethod
    def of(cls, arm: ArmParameters, kinds: Sequence[str], joints: Sequence[int]) -> Space:
        chosen = [
            Parameter(joint, kind)
            for joint in joints
            for kind in kinds
            if kind not in OF_THE_ARM and (kind != "offset" or joint in PITCH_JOINTS)
        ]
        chosen += [Parameter(WHOLE_ARM, kind) for kind in kinds if kind in OF_THE_ARM]
        return cls(arm, tuple(chosen), plant_row(arm))

    def __len__(self) -> int:
        return len(self.parameters)

    def kind(self, index: int) -> Kind:
        return KINDS[self.parameters[index].kind]

    @property
    def names(self) -> tuple[str, ...]:
        return tuple(parameter.name for parameter in self.parameters)

    @property
    def steps(self) -> Floats:
        return np.array([self.kind(index).step for index in range(len(self))])

    def doubts(self) -> Floats:
        """Return the standard deviations of the searched numbers: how far a value may be from the user's arm."""
        return np.array([self.kind(index).doubt for index in range(len(self))])

    def doubts_at(self, x: Floats) -> Floats:
        """Return them for who found `x`: an arm file that was off by more than its doubt is doubted that far."""
        return np.maximum(self.doubts(), np.abs(x - self.start()))

    def start(self) -> Floats:
        """The user's arm, or a usual value where the arm gives none (no friction, for example)."""
        return np.array([self.kind(n).to_search(self._known(one)) for n, one in enumerate(self.parameters)])

    def bounds(self) -> tuple[Floats, Floats]:
        """Lowest and highest searched number of each quantity."""
        pairs = [
            (at + math.log(kind.low), at + math.log(kind.high)) if kind.logarithmic else (kind.low, kind.high)
            for at, kind in zip(self.start(), map(self.kind, range(len(self))), strict=True)
        ]
        low, high = np.array(pairs).reshape(-1, 2).T
        return low, high

    def values(self, x: Floats) -> Floats:
        """The values in physical units."""
        return np.array([self.kind(index).from_search(float(number)) for index, number in enumerate(x)])

    def translate(self, x: Floats, source: Space) -> Floats:
        """A vector of another space in this one; a number that the other does not have starts as usual."""
        known = dict(zip(source.names, x, strict=True))
        start = self.start()
        return np.array([known.get(name, start[index]) for index, name in enumerate(self.names)])

    def groups(self) -> tuple[NDArray[np.intp], ...]:
        """Numbers that can be varied together, because no two of them belong to joints that feel each other."""
        columns: list[list[int]] = []
        for joints in COUPLED:
            mine = [index for index, one in enumerate(self.parameters) if one.joint in joints]
            columns += [[] for _ in range(len(mine) - len(columns))]
            for group, index in zip(columns, mine, strict=False):
                group.append(index)
        columns += [[index] for index, one in enumerate(self.parameters) if one.joint == WHOLE_ARM]
        return tuple(np.array(group, dtype=np.intp) for group in columns)

    def mix(self, fits: Sequence[Floats], errors: Floats, joints: Sequence[int]) -> Floats:
        """Return the numbers of the best fit for each group of coupled joints, by errors (fits, moving `joints`)."""
        mixed = fits[0].copy()
        for coupled in COUPLED:
            mine = [place for place, joint in enumerate(joints) if joint in coupled]
            best = fits[int(np.argmin(errors[:, mine].sum(axis=1)))]
            mine = [index for index, one in enumerate(self.parameters) if one.joint in coupled]
            mixed[mine] = best[mine]
        return mixed

    def moves(self, joint_of: NDArray[np.intp]) -> NDArray[np.bool_]:
        """True for each searched number that changes numbers of a residual of these joints; (numbers, searched)."""
        table = np.zeros((JOINTS + 1, len(self)), dtype=bool)
        table[:, [index for index, one in enumerate(self.parameters) if one.joint == WHOLE_ARM]] = True
        for joints in COUPLED:
            for index, one in enumerate(self.parameters):
                if one.joint in joints:
                    table[list(joints), index] = True
        return table[joint_of]

    def plants(self, points: Floats) -> Floats:
        """Plants (rows, columns) of searched points (rows)."""
        rows = np.tile(self.base, (len(points), 1))
        found = {name: points[:, index] for index, name in enumerate(self.names)}
        supply = self.base[column("supply")]
        for joint in range(JOINTS):
            here = {kind: found[f"joint{joint}.{kind}"] for kind in KINDS if f"joint{joint}.{kind}" in found}
            if here:
                _set_joint(rows, joint, here, supply)
        if "arm.sag" in found:
            rows[:, column("supply_resistance")] = found["arm.sag"]
        if "arm.tip" in found:
            # Every constant of the links is linear in a point mass.
            heavier = self.arm.model_copy(update={"tip": Tip(mass=self.arm.tip.mass + 1.0)})
            rows += (found["arm.tip"] - self.arm.tip.mass)[:, None] * (plant_row(heavier) - plant_row(self.arm))
        return rows

    def offsets(self, points: Floats) -> Floats:
        """Zero angles (rows, 4) of searched points, rad; 0 where they are not searched."""
        angles = np.zeros((len(points), JOINTS))
        for index, parameter in enumerate(self.parameters):
            if parameter.kind == "offset":
                angles[:, parameter.joint] = points[:, index]
        return angles

    def _known(self, parameter: Parameter) -> float:
        if parameter.kind == "sag":
            return self.arm.drive.supply_resistance or KINDS["sag"].start
        if parameter.kind == "tip":
            return self.arm.tip.mass
        pot = self.arm.follower_pots.joint[parameter.joint]
        joint = self.arm.joint[parameter.joint]
        motor = self.arm.actuator(parameter.joint)
        alpha = 1.0 / motor.torque_per_volt
        usual = KINDS[parameter.kind].start
        known = {
            "alpha": alpha,
            "inertia": alpha * motor.inertia,
            "damping": alpha * motor.damping,
            "coulomb": alpha * joint.friction.coulomb or usual,
            "breakaway": joint.friction.breakaway / joint.friction.coulomb - 1.0 if joint.friction.coulomb else usual,
            "stribeck": joint.friction.stribeck_velocity,
            "gap": joint.gear.half_gap or usual,
            "drag": joint.gear.drag / motor.damping or usual,
            "teeth": motor.torque_per_volt * self.arm.drive.supply / joint.gear.stiffness
            if joint.gear.stiffness
            else usual,
            "ringing": joint.gear.damping / joint.gear.stiffness if joint.gear.damping else usual,
            "play": pot.play or usual,
            "load": joint.friction.load or usual,
            "creep": joint.friction.creep_velocity or usual,
            "lag": pot.lag or usual,
            "lost": 0.5 * (joint.driver.lost_up + joint.driver.lost_down) or usual,
            "uneven": 0.5 * (joint.driver.lost_up - joint.driver.lost_down),
            "offset": 0.0,
        }
        return known[parameter.kind]


# Quantities that are columns of a plant as they are searched.
_AS_THEY_ARE = {
    "gap": "half_gap",
    "play": "pot_play",
    "load": "load_friction",
    "creep": "creep_velocity",
    "lag": "pot_lag",
}


def _set_joint(rows: Floats, joint: int, here: dict[str, Floats], supply: float) -> None:
    """Write searched numbers of one joint into its columns."""
    torque = rows[:, column("torque_per_volt", joint)]
    volts_before = 1.0 / torque.copy()
    if "alpha" in here:
        torque[:] = np.exp(-here["alpha"])
        rows[:, column("resistance", joint)] /= torque * volts_before
    for kind in ("inertia", "damping"):
        values = rows[:, column(kind, joint)]
        # Quantities that are not searched keep their volts, because the volts move the joint.
        values[:] = (np.exp(here[kind]) if kind in here else values * volts_before) * torque
    sliding, rest = rows[:, column("coulomb", joint)], rows[:, column("breakaway", joint)]
    excess = np.where(sliding > 0.0, rest / np.where(sliding > 0.0, sliding, 1.0) - 1.0, 0.0)
    sliding[:] = (np.exp(here["coulomb"]) if "coulomb" in here else sliding * volts_before) * torque
    rest[:] = sliding * (1.0 + here.get("breakaway", excess))
    if "stribeck" in here:
        rows[:, column("stribeck_velocity", joint)] = np.exp(here["stribeck"])
    if "drag" in here:
        rows[:, column("drag", joint)] = np.exp(here["drag"]) * rows[:, column("damping", joint)]
    for kind, name in _AS_THEY_ARE.items():
        if kind in here:
            rows[:, column(name, joint)] = here[kind]
    if "lost" in here:
        lost, more = here["lost"], here["uneven"]
        rows[:, column("lost_up", joint)] = np.maximum(lost + more, 0.0)
        rows[:, column("lost_down", joint)] = np.maximum(lost - more, 0.0)
    if "gap" in here or "teeth" in here or "ringing" in here:
        stiffness, mesh = rows[:, column("stiffness", joint)], rows[:, column("mesh_damping", joint)]
        lasting = np.where(stiffness > 0.0, mesh / np.where(stiffness > 0.0, stiffness, 1.0), KINDS["ringing"].start)
        if "teeth" in here or not stiffness.any():
            stiffness[:] = torque * supply / np.exp(here.get("teeth", math.log(KINDS["teeth"].start)))
        mesh[:] = stiffness * (np.exp(here["ringing"]) if "ringing" in here else lasting)
