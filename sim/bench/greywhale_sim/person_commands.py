"""Commands to the person at a running bench, in degrees, as `greywhale calibrate` asks for them."""

from __future__ import annotations

from typing import Any

import numpy as np

from greywhale import _native
from greywhale.arm.parameters import JOINT_NAMES
from greywhale.base.errors import UserError
from greywhale_sim.server import Server

ENDS_DEG = tuple(np.degrees(_native.Person.ENDS))  # of a sweep, the positive one first
HANGING_DEG = np.degrees(_native.Person.HANGING)  # of joints 0..3
FARTHEST_DEG, LONGEST_S = 359.0, 60.0  # that a command may ask for

HELP = """\
turn leader 0      leader joint 0 to its positive end, its negative end, back
turn leader 0 3    the same with 3 seconds each way; follower as well
hold 30            both arms with every joint at 30 degrees
hold 60 50 -45 40  both arms with each joint at an angle of its own
hang               the follower hangs down, for the motors' pulses
mistake NAME       wire it wrongly, a name of sim --mistake list; none mends all
estop press        the emergency stop's button; release
clutch press       the clutch's pedal; release
quit               end the bench; docs/bench.md has more commands"""


def turn(server: Server, side: str, joint: str, seconds: str = f"{_native.Person.EACH_WAY_S}") -> dict[str, Any]:
    """Turn one joint to its positive end, to its negative end, and back; each way takes so many seconds."""
    number, each_way = int(joint), float(seconds)
    if side not in ("leader", "follower") or not 0 <= number < len(JOINT_NAMES) or not 0.0 < each_way <= LONGEST_S:
        raise ValueError
    if server.bench.leader.on_the_way:
        raise UserError("the hands are still on their way; wait until they are there.")
    server.bench.leader.require_held()
    takes_s = server.bench.leader.turn(number + len(JOINT_NAMES) * (side == "follower"), each_way)
    ends = " and then to ".join(f"{end:g}" for end in ENDS_DEG)
    return _arriving(
        server, takes_s, f"{side} joint {number}, {JOINT_NAMES[number]}, turns to {ends} degrees, and back"
    )


def hold(server: Server, *degrees: str) -> dict[str, Any]:
    """Hold both arms in one pose: an angle for each joint, or one for all."""
    angles = np.array([float(word) for word in degrees])
    if len(angles) not in (1, len(JOINT_NAMES)) or not np.all(np.abs(angles) <= FARTHEST_DEG):
        raise ValueError
    pose = np.radians(np.broadcast_to(angles, len(JOINT_NAMES)))
    server.bench.leader.require_held()
    return _arriving(server, server.bench.leader.pose(pose), f"both arms go to {' '.join(degrees)} degrees")


def hang(server: Server) -> dict[str, Any]:
    """Let the follower hang, as it should when its motors get pulses."""
    server.bench.leader.require_held()
    return _arriving(server, server.bench.leader.hang(), "the follower hangs down")


def explain(server: Server) -> dict[str, Any]:
    """Answer with the list of these commands."""
    return {"says": HELP}


def _arriving(server: Server, seconds: float, says: str) -> dict[str, Any]:
    return {
        "says": f"{says}; {seconds:g} s.",
        "takes_s": round(seconds, 6),
        "arrives_s": round(server.bench.time_s + seconds, 6),
    }
