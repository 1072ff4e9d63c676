"""Limits of an arm that is made from a URDF or from answers: what is doubted or refused, and what is guessed."""

from __future__ import annotations

from dataclasses import dataclass

from greywhale.base.limits import limit


@dataclass(frozen=True)
class UrdfLimits:
    """Numbers of a URDF, and how it fits four joints."""

    largest_file_bytes: int = limit(4 << 20, "bytes", "no URDF of an arm is larger")
    heaviest_kg: float = limit(1e4, "kg", "of a link; what is heavier would only overflow")
    largest_number: float = limit(1e6, "m or rad", "what is larger would only overflow")
    beside_m: float = limit(1e-3, "m", "axes that shall meet may pass each other so far")
    aside_share: float = limit(0.15, "of a link's length", "a centre of mass may lie so far beside the link")
    aside_m: float = limit(5e-3, "m", "or so far")
    shortest_m: float = limit(1e-3, "m", "shorter links have no direction")


@dataclass(frozen=True)
class DoubtLimits:
    """Arms that no Arduino moves: mostly a wrong unit."""

    furthest_reach_m: float = limit(5.0, "m", "arms that an Arduino moves reach less far")
    most_gyration_reaches: float = limit(2.0, "times the reach", "of a body; inertias in kg mm² are more")
    densest_kg_m3: float = limit(1000.0, "kg/m³", "water that fills a cube of the reach; masses in g are more")
    rounding_share: float = limit(0.01, "of the inertia", "rounded digits may break the rules for inertias so little")
    far_too_strong_ratio: float = limit(40.0, "times gravity", "such a motor fits another arm, or has another unit")
    far_too_weak_ratio: float = limit(0.1, "times gravity", "as does such a one")
    slowest_rad_s: float = limit(0.05, "rad/s", "of a joint that follows a hand")
    fastest_rad_s: float = limit(60.0, "rad/s", "of such a joint too")
    much_gravity_share: float = limit(0.5, "of the stall torque", "what is left moves a joint slowly")
    most_noise_v: float = limit(0.5, "V rms", "a tenth of the range, of which no angle could be read")
    back_emf_share: float = limit(0.95, "of a motor's damping", "so that viscous friction stays positive")


@dataclass(frozen=True)
class Guesses:
    """Numbers for what a URDF or a person does not say."""

    inertia_kg_m2: tuple[float, ...] = limit((0.02, 0.03, 0.015, 0.005), "kg m²", "of motor and gears, at the joint")
    torque_ratio: float = limit(3.0, "times the torque needed", "a motor of unknown effort carries the arm")
    brisk_rad_s2: float = limit(10.0, "rad/s²", "and starts it as a hand would")
    rad_s: float = limit(5.0, "rad/s", "a hobby servo's")
    same_damping_share: float = limit(0.1, "of the damping", "as effort and velocity give it: within this it is that")
    no_load_share: float = limit(0.05, "of the stall current", "usual without a load")
    breakaway_ratio: float = limit(1.25, "times sliding friction", "friction at rest")
    time_constant_s: float = limit(0.02, "s", "a brushed motor alone is at full speed about three times as late")
    noise_v: float = limit(0.0024, "V rms", "of a usual potentiometer")


URDF = UrdfLimits()
DOUBTS = DoubtLimits()
GUESSES = Guesses()
