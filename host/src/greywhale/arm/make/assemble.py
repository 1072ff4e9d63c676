"""From answers to an arm file's content, in SI units."""

from __future__ import annotations

import math
from typing import Any

from greywhale.arm.limits import GUESSES
from greywhale.arm.make.body import MATERIALS, Body, Section, bar, tube, uniform, with_parts
from greywhale.arm.make.motor import RAD_S_PER_RPM, DataSheet, tables
from greywhale.arm.make.questions import Answers
from greywhale.arm.parameters import JOINT_NAMES, ArmParameters

MM, GRAM, GRAM_CM2 = 1e-3, 1e-3, 1e-7  # in m, kg and kg m2
SPARE_RAD = math.radians(5.0)  # of a track beyond the joint's range


def assemble(answers: Answers) -> ArmParameters:
    """The arm that the answers of `questions.collect` describe."""
    pot = [_pot(one, math.radians(answers["track_deg"])) for one in answers["joint"]]
    data = {
        "name": answers["name"],
        "source": "geometry, masses and data sheets, as answered to greywhale arm new",
        "link": [_link(number, one) for number, one in enumerate(answers["link"])],
        "tip": {"mass": GRAM * answers["tip_g"]},
        "joint": [_joint(number, one) for number, one in enumerate(answers["joint"])],
        "drive": {"supply": answers["supply_v"]},
        "leader_pots": {"joint": pot},
        "follower_pots": {"joint": pot},
    }
    return ArmParameters.model_validate(data, strict=False)


def data_sheet(one: Answers) -> DataSheet:
    """A joint's motor in SI units."""
    return DataSheet(
        rated_v=one["rated_v"],
        gear_ratio=one["gear_ratio"],
        stall_torque=one["stall_torque_nm"],
        stall_current=one["stall_current_a"],
        no_load_speed=RAD_S_PER_RPM * one["no_load_rpm"],
        no_load_current=one["no_load_current_a"],
        rotor_inertia=GRAM_CM2 * one["rotor_inertia_gcm2"],
    )


def _section(one: Answers) -> Section:
    if one["section"] == "tube":
        return tube(MM * one["outer_mm"], MM * one["wall_mm"])
    return bar(MM * one["width_mm"], MM * one["height_mm"])


def _link(number: int, one: Answers) -> dict[str, Any]:
    section, length = _section(one), MM * one["length_mm"]
    material = one["mass_g"]
    mass = MATERIALS[material] * section.area * length if isinstance(material, str) else GRAM * material
    body = uniform(section, length, mass)
    parts, at = GRAM * one["parts_g"], MM * one.get("parts_at_mm", 0.0)
    if number == 0:
        return _turret(body, length, parts, at)
    if parts:
        body = with_parts(body, parts, at)
    inertia = {"xx": body.along, "yy": body.about_height, "zz": body.about_width}
    return {"mass": body.mass, "length": length, "centre": body.centre, "inertia": inertia}


def _turret(body: Body, length: float, parts: float, beside: float) -> dict[str, Any]:
    """It stands upright, its y up, and does nothing but turn about the vertical; parts are beside that by `beside`."""
    turning = body.along + parts * beside**2
    across = max(body.about_width, turning)
    inertia = {"xx": across, "yy": turning, "zz": across}
    return {"mass": body.mass + parts, "length": length, "centre": length / 2.0, "inertia": inertia}


def _joint(number: int, one: Answers | None) -> dict[str, Any]:
    if one is None:
        return {"name": JOINT_NAMES[number], "fixed": True}
    stops = {"min": math.radians(one["min_deg"]), "max": math.radians(one["max_deg"])}
    return {"name": JOINT_NAMES[number], **tables(data_sheet(one)), "stops": stops}


def _pot(one: Answers | None, track: float) -> dict[str, float]:
    """In the middle of its track at 0 where the range allows it, else in the middle of the range."""
    if one is None:
        return {"track": track, "centre": 0.0, "noise": GUESSES.noise_v}
    low, high = math.radians(one["min_deg"]), math.radians(one["max_deg"])
    fits = max(-low, high) + SPARE_RAD <= track / 2.0
    return {"track": track, "centre": 0.0 if fits else (low + high) / 2.0, "noise": GUESSES.noise_v}
