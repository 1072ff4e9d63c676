"""The content of an arm.toml: geometry, motors, friction, gears, stops, potentiometers; checked as physics."""

from __future__ import annotations

import math
from typing import Annotated, Any, ClassVar, Literal, TypeVar

from pydantic import AfterValidator, Field, SerializerFunctionWrapHandler, model_serializer, model_validator

from greywhale import _native
from greywhale.arm.limits import DOUBTS, GUESSES
from greywhale.base.formats.kinds import Kind
from greywhale.base.formats.toml_file import Table
from greywhale.protocol.joints import Joints

# The usual potentiometer: a track of 300 degrees, and noise of half a step of the board's converter (V rms).
USUAL_TRACK_RAD = math.radians(300.0)
JOINT_NAMES = ("base yaw", "shoulder pitch", "wrist pitch", "wrist roll")
PITCH_JOINTS = (1, 2)  # only these feel gravity
PAPER_IYY0 = 8.26e-3  # as printed in the paper's Table 3

# Ranges that every arm keeps by far, from a wristwatch's gears to the largest industrial robots: what lies beyond is a
# slip of the keys or another unit, and would only make numbers overflow. The paper's method may find odd motors.
Mass = Annotated[float, Field(ge=1e-9, le=1e4)]  # kg
Length = Annotated[float, Field(ge=1e-4, le=100)]  # m
Moment = Annotated[float, Field(ge=1e-18, le=1e8)]  # kg m2
Torque = Annotated[float, Field(ge=0, le=1e6)]  # N m
Viscosity = Annotated[float, Field(ge=0, le=1e12)]  # N m s
Item = TypeVar("Item")


def _one_per_joint(items: tuple[Item, ...]) -> tuple[Item, ...]:
    if len(items) != len(JOINT_NAMES):
        raise ValueError(f"it lists {len(items)}, but the arm needs exactly four: {', '.join(JOINT_NAMES)}")
    return items


class Inertia(Table):
    """Principal moments about the centre of mass, kg m2; x along the link, y up at zero pitch, z the pitch axis."""

    xx: Moment
    yy: Moment
    zz: Moment

    @model_validator(mode="after")
    def _is_a_body(self) -> Inertia:
        for key, one, others in (
            ("xx", self.xx, ("yy", "zz")),
            ("yy", self.yy, ("xx", "zz")),
            ("zz", self.zz, ("xx", "yy")),
        ):
            rest = sum(getattr(self, other) for other in others)
            if one > rest * (1 + 1e-9):
                raise ValueError(
                    f"{key} is {one:g}, more than {others[0]} + {others[1]} = {rest:g}, which no body can have "
                    f"(triangle inequality of moments of inertia){_printed_value(key, one)}"
                )
        return self


def _printed_value(key: str, value: float) -> str:
    if key == "yy" and math.isclose(value, PAPER_IYY0):
        return "; the paper's Table 3 prints this value for link 0, 8.26e-5 is probably meant"
    return ""


class Link(Table):
    mass: Mass  # kg
    length: Length  # m
    centre: Annotated[float, Field(ge=0, le=100)]  # m, centre of mass from the nearer joint
    inertia: Inertia

    @model_validator(mode="after")
    def _centre_is_on_the_link(self) -> Link:
        if self.centre > self.length:
            raise ValueError(f"centre is {self.centre:g} m, beyond the link's length of {self.length:g} m")
        return self


class Tip(Table):
    """The load that the arm carries at the end of link 3."""

    mass: Annotated[float, Field(ge=0, le=1e4)] = 0.0  # kg


class Motor(Table):
    """A geared DC motor; motor speed = gear_ratio x joint speed, back-EMF constant = torque constant."""

    inertia: Moment  # J, kg m2
    resistance: Annotated[float, Field(ge=1e-18, le=1e12)]  # R, ohm
    torque_constant: Annotated[float, Field(ge=1e-18, le=1e6)]  # Kt, N m/A
    viscous: Viscosity  # Bm, N m s
    gear_ratio: Annotated[float, Field(ge=1e-3, le=1e6)]  # N


class Friction(Table):
    """Dry friction of motor and gear train, as torque at the joint."""

    coulomb: Torque = 0.0  # N m, sliding
    breakaway: Torque = 0.0  # N m, at rest
    stribeck_velocity: Annotated[float, Field(ge=1e-9, le=1e3)] = (
        0.1  # rad/s, where the excess of breakaway over coulomb has halved
    )
    load: Annotated[float, Field(ge=0, le=0.9)] = 0.0  # share of the torque passed on, which adds to both
    creep_velocity: Annotated[float, Field(ge=0, le=1)] = 0.0  # rad/s just below breakaway; 0: holds still

    @model_validator(mode="after")
    def _rest_holds_more(self) -> Friction:
        if self.breakaway < self.coulomb:
            raise ValueError(
                f"breakaway is {self.breakaway:g} N m, below coulomb = {self.coulomb:g} N m; "
                "a shaft at rest holds at least as much"
            )
        return self


class Gear(Table):
    """The mesh between motor and link, at the joint; all zero is a rigid gear."""

    half_gap: Annotated[float, Field(ge=0, le=0.5)] = 0.0  # rad, to either side
    stiffness: Annotated[float, Field(ge=0, le=1e9)] = 0.0  # N m/rad, of the teeth in contact
    damping: Viscosity = 0.0  # N m s, of the teeth in contact
    drag: Viscosity = 0.0  # N m s, of the grease, also with the teeth apart

    @model_validator(mode="after")
    def _gap_needs_teeth(self) -> Gear:
        if self.half_gap > 0 and self.stiffness == 0:
            raise ValueError(f"half_gap is {self.half_gap:g} rad, so stiffness must be above 0 N m/rad")
        return self


class Driver(Table):
    """The bridge that drives a motor: what it keeps for itself of a voltage, of which less does nothing."""

    lost_up: Annotated[float, Field(ge=0, le=10)] = 0.0  # V, of voltages above 0
    lost_down: Annotated[float, Field(ge=0, le=10)] = 0.0  # V, of voltages below 0


class Stops(Table):
    """Mechanical end stops of the joint."""

    min: Annotated[float, Field(ge=-math.tau, le=math.tau)]  # rad
    max: Annotated[float, Field(ge=-math.tau, le=math.tau)]  # rad

    @model_validator(mode="after")
    def _in_order(self) -> Stops:
        if self.min >= self.max:
            raise ValueError(f"min is {self.min:g} rad, not below max = {self.max:g} rad; swap or correct them")
        return self


# What stands for the motor and the stops that a joint which is not in use need not have; nothing works with them.
_NO_MOTOR = {"inertia": 1e-3, "resistance": 1.0, "torque_constant": 1.0, "viscous": 0.0, "gear_ratio": 1.0}
_NO_STOPS = {"min": -1.0, "max": 1.0}


class Joint(Table):
    """Everything between a joint's two wires and its output shaft.

    A `fixed` joint is not in use: it is rigid at 0 rad, whatever else is said of it.
    """

    name: str = ""
    fixed: bool = False
    motor: Motor
    friction: Friction = Friction()
    gear: Gear = Gear()
    stops: Stops
    driver: Driver = Driver()

    @model_validator(mode="before")
    @classmethod
    def _needs_nothing_when_fixed(cls, data: Any) -> Any:
        if isinstance(data, dict) and data.get("fixed") is True:
            return {"motor": _NO_MOTOR, "stops": _NO_STOPS} | data
        return data

    @model_serializer(mode="wrap")
    def _say_nothing_else_when_fixed(self, whole: SerializerFunctionWrapHandler) -> dict[str, Any]:
        if self.fixed:
            return {"name": self.name, "fixed": True}
        data: dict[str, Any] = whole(self)
        data.pop("fixed", None)
        return data


class Drive(Table):
    supply: Annotated[float, Field(gt=0, le=60)]  # V, without load
    supply_resistance: Annotated[float, Field(ge=0, le=10)] = 0.0  # ohm, of battery and cables, for all motors together
    resistance: Annotated[float, Field(ge=0, le=10)] = 0.0  # ohm, of one driver, in line with its motor's
    pwm_levels: Annotated[int, Field(ge=0, le=65535)] = 0  # duty steps from 0 to full; 0: not quantised here


class Potentiometer(Table):
    """One joint potentiometer across the board's supply."""

    track: Annotated[float, Field(gt=0, le=10 * math.tau)] = USUAL_TRACK_RAD  # rad, end to end
    centre: Annotated[float, Field(ge=-10 * math.tau, le=10 * math.tau)] = 0.0  # rad, joint angle at mid-track
    direction: Literal[1, -1] = 1  # sign of the voltage's slope
    noise: Annotated[float, Field(ge=0, le=DOUBTS.most_noise_v)] = 0.0  # V rms
    linearity: Annotated[float, Field(ge=0, le=0.05)] = 0.0  # largest deviation, share of full scale
    play: Annotated[float, Field(ge=0, le=0.2)] = 0.0  # rad, half of the play between joint and wiper
    lag: Annotated[float, Field(ge=0, le=0.05)] = 0.0  # s, time constant of the low-pass behind the wiper


class PotentiometerBank(Table):
    """The four potentiometers of one arm."""

    supply: Annotated[float, Field(ge=0.1, le=60)] = 5.0  # V, also the converter's reference
    joint: Annotated[tuple[Potentiometer, ...], AfterValidator(_one_per_joint)] = (Potentiometer(),) * 4


def usual_pots() -> PotentiometerBank:
    """Potentiometers as most arms have them, for an arm whose own are not known."""
    return PotentiometerBank(joint=(Potentiometer(noise=GUESSES.noise_v),) * 4)


class ArmParameters(Table):
    """A leader-follower arm as simulated: the follower's mechanics and both arms' potentiometers."""

    kinds: ClassVar[tuple[Kind, ...]] = (Kind.ARM, Kind.MODEL)

    name: str
    source: str = ""
    gravity: Annotated[float, Field(ge=0, le=100)] = 9.81  # m/s2
    motor_equation: Literal["physical", "paper"] = "physical"
    link: Annotated[tuple[Link, ...], AfterValidator(_one_per_joint)]
    tip: Tip = Tip()
    joint: Annotated[tuple[Joint, ...], AfterValidator(_one_per_joint)]
    drive: Drive
    leader_pots: PotentiometerBank = PotentiometerBank()
    follower_pots: PotentiometerBank = PotentiometerBank()
    identification: dict[str, Any] | None = None  # how `greywhale identify` found this arm; the plant ignores it

    @model_validator(mode="after")
    def _moves(self) -> ArmParameters:
        if not self.joints_in_use:
            raise ValueError("all four joints are fixed; an arm needs one that moves")
        return self

    @model_validator(mode="after")
    def _drivers_leave_volts(self) -> ArmParameters:
        for number in self.joints_in_use:
            up, down = self.joint[number].driver.lost_up, self.joint[number].driver.lost_down
            if up + down > 2.0 * self.drive.supply:
                raise ValueError(
                    f"joint[{number}].driver loses lost_up + lost_down = {up + down:g} V, more than twice the supply "
                    f"of {self.drive.supply:g} V; no driver loses more than it gets"
                )
        return self

    @property
    def joints_in_use(self) -> Joints:
        return tuple(number for number, joint in enumerate(self.joint) if not joint.fixed)

    def actuator(self, joint: int) -> _native.Actuator:
        """The motor of one joint as its output shaft feels it, by this arm's motor equation; a fixed one has none."""
        if self.joint[joint].fixed:
            return _native.physical_actuator(**(_NO_MOTOR | {"torque_constant": 0.0}))
        motor = self.joint[joint].motor
        equation = _native.physical_actuator if self.motor_equation == "physical" else _native.paper_actuator
        return equation(**(dict(motor) | {"resistance": motor.resistance + self.drive.resistance}))

    def native(self) -> _native.ArmParameters:
        """These parameters for the C++ plant."""
        return _native.ArmParameters(
            links=[_native_link(link) for link in self.link],
            tip_mass=self.tip.mass,
            gravity=self.gravity,
            joints=[self._native_joint(index) for index in range(len(self.joint))],
            supply=self.drive.supply,
            supply_resistance=self.drive.supply_resistance,
            pwm_levels=self.drive.pwm_levels,
        )

    def _native_joint(self, index: int) -> _native.Joint:
        joint, pot = self.joint[index], self.follower_pots.joint[index]
        if joint.fixed:
            rigid = {"coulomb": 0.0, "breakaway": 0.0, "stribeck_velocity": 1.0}
            rigid |= dict.fromkeys(("half_gap", "stiffness", "damping", "drag", "min", "max"), 0.0)
            return _native.Joint(actuator=self.actuator(index), **rigid)
        friction = dict(joint.friction)
        friction["load_friction"] = friction.pop("load")
        parts = friction | dict(joint.gear) | dict(joint.stops) | dict(joint.driver)
        return _native.Joint(actuator=self.actuator(index), pot_play=pot.play, pot_lag=pot.lag, **parts)


def _native_link(link: Link) -> _native.Link:
    inertia = link.inertia
    return _native.Link(
        mass=link.mass, length=link.length, centre=link.centre, ixx=inertia.xx, iyy=inertia.yy, izz=inertia.zz
    )


def with_usual_noise(arm: ArmParameters) -> ArmParameters:
    """A copy of the arm with the noise of a usual potentiometer on every one that has none."""
    banks = {}
    for name in ("leader_pots", "follower_pots"):
        bank = getattr(arm, name)
        pots = tuple(
            pot if pot.noise > 0.0 else pot.model_copy(update={"noise": GUESSES.noise_v}) for pot in bank.joint
        )
        banks[name] = bank.model_copy(update={"joint": pots})
    return arm.model_copy(update=banks)
