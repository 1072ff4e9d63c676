"""The same recordings through `greywhale identify` itself: as logs of an arm of which one joint moves.

A foreign controller is unknown to it, so that it works on the logged voltages alone.
"""

from __future__ import annotations

import math
from dataclasses import replace

import numpy as np

from greywhale.arm import ArmParameters
from greywhale.base.types import Floats
from greywhale.files.log import Log
from greywhale.files.log.layout import Origin
from greywhale.identify import identify
from greywhale.protocol.firmware import JOINTS
from greywhale.simulate import PLANT_COLUMNS
from studies.one_joint.plant import COLUMNS, Rig
from studies.real_data.rigs import Source

STOP = 2 * math.pi  # no stop is known
DUST_KG = 1e-6  # of links that the rig does not have


def joint_of(rig: Rig) -> int:
    """A joint that swings a weight is a shoulder; one that feels none a base yaw."""
    return 1 if rig.weight > 0.0 else 0


def log_of(source: Source) -> Log:
    """The record as greywhale's own log. The arm's pitch is level at 0, where a pendulum hangs."""
    record, joint = source.record, joint_of(source.rig)
    turn = -math.pi / 2 if joint == 1 else 0.0
    leader, follower, voltage = (np.zeros((len(record.time), JOINTS)) for _ in range(3))
    leader[:, joint], follower[:, joint], voltage[:, joint] = record.leader + turn, record.follower + turn, record.volts
    return Log(
        name=record.name,
        origin=Origin(),
        time=record.time,
        leader=leader,
        follower=follower,
        voltage=voltage,
        state=np.full(len(record.time), "following"),
        dropped=0,
        complete=True,
    )


def arm_of(rig: Rig, gravity: float = 9.80665) -> ArmParameters:
    """An arm file's content from what is published: N = 1, Bm = 0, and Kt, R, J by the white box's combinations."""
    alpha = rig.alpha
    motor = {
        "inertia": rig.inertia / alpha,
        "resistance": alpha * rig.damping,
        "torque_constant": rig.damping,
        "viscous": 0.0,
        "gear_ratio": 1.0,
    }
    dust = {"mass": DUST_KG, "length": 0.01, "centre": 0.005, "inertia": {"xx": 1e-10, "yy": 1e-10, "zz": 1e-10}}
    links = [dict(dust) for _ in range(JOINTS)]
    if rig.weight > 0.0:
        length = rig.link_inertia * gravity / rig.weight
        mass = rig.weight / gravity / length
        links[1] |= {"mass": mass, "length": length, "centre": length}
    joint = {"motor": motor, "stops": {"min": -STOP, "max": STOP}}
    content = {
        "name": rig.name,
        "gravity": gravity,
        "link": tuple(links),
        "joint": (joint,) * JOINTS,
        "drive": {"supply": rig.supply},
    }
    return ArmParameters.model_validate(content)


def identified(source: Source) -> Floats:
    """What `greywhale identify` finds in a record, as a plant (1, 19) of one joint."""
    rig = source.rig
    outcome = identify([log_of(source)], arm_of(rig))
    joint = joint_of(rig)
    plant = dict(zip(PLANT_COLUMNS, outcome.plant, strict=True))
    own = {"link_inertia": rig.link_inertia, "weight": rig.weight, "hanging": outcome.zero[joint] * -1.0}
    row = [own.get(name, plant.get(f"joint{joint}.{name}", 0.0)) for name in COLUMNS]
    return np.array([row])


def shortened(source: Source) -> Source:
    """The first half, if identification takes a log as short as that, else the whole."""
    half = source.record.until(source.record.middle)
    return replace(source, record=half) if half.time[-1] - half.time[0] > 4.5 else source
