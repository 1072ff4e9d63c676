"""The mistakes that a person may make with an arm, by name: the effect on the bench, and the verb that names it.

The one list behind `greywhale sim --mistake`, the bench's command `mistake`, the site and the tests.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from typing import Literal

from greywhale.arm import PotFault, Wiring
from greywhale.base.errors import UserError
from greywhale.board.refusal import pot_name
from greywhale.protocol.firmware import JOINTS
from greywhale_sim.bench import Bench

POTS = tuple(f"{side}{joint}" for side in ("leader", "follower") for joint in range(JOINTS))
WHERE = {"pot": POTS, "motor": tuple(map(str, range(JOINTS))), "arm": ("",)}
GROUPS = {"pot": "Potentiometers", "motor": "Motors", "arm": "Plugs and power"}
USUAL = {"pot": "follower1", "motor": "1", "arm": ""}
WEAK_GAIN = 0.2  # of a healthy motor's torque
OTHER_SUPPLY_V = 24.0  # of a power supply taken by mistake
NOTHING = "none"

Call = tuple[str | int | float | PotFault | Wiring, ...]  # a method of the bench by its name, and what it is given
Calls = tuple[Call, ...]


@dataclass(frozen=True)
class Fault:
    """A fault: `calls` of a bench's methods do it at the potentiometer 0..7 or the joint 0..3 in question.

    `verb` then finds it, with words that match the regular expression `words`. In it stand <pot>, <other>, <first>,
    <second> for potentiometers and <joint>, <near>, <low>, <high> for joints; `near` is the one with which something is
    exchanged. A `mended` fault is put right by the verb itself; for others its exit code is 1, or 0 if `noted`.
    """

    name: str
    on: Literal["pot", "motor", "arm"]
    title: str  # as people say it
    says: str
    verb: Literal["calibrate", "doctor"]
    words: str
    calls: Callable[[int], Calls]
    ends: Literal["refused", "mended", "noted"] = "refused"
    options: tuple[str, ...] = ()

    def tells(self, number: int) -> str:
        """The regular expression for this place."""
        joint = number % JOINTS
        near = (joint + 1) % JOINTS
        other = number - joint + near
        pots = {"pot": number, "other": other, "first": min(number, other), "second": max(number, other)}
        joints = {"joint": joint, "near": near, "low": min(joint, near), "high": max(joint, near)}
        text = self.words
        for key, value in pots.items():
            text = text.replace(f"<{key}>", pot_name(value)[1:])
        for key, value in joints.items():
            text = text.replace(f"<{key}>", str(value))
        return text.replace("<id>", POTS[number])


def _near(number: int) -> int:
    return number - number % JOINTS + (number + 1) % JOINTS


def _at_pot(kind: PotFault) -> Callable[[int], Calls]:
    return lambda pot: (("inject", pot, kind),)


def _wire(wiring: Wiring) -> Callable[[int], Calls]:
    return lambda pot: (("set_wiring", pot, wiring),)


def _motor(gain: float) -> Callable[[int], Calls]:
    return lambda joint: (("wire_motor", joint, gain, joint),)


def _swap_motors(joint: int) -> Calls:
    near = (joint + 1) % JOINTS
    return (("wire_motor", joint, 1.0, near), ("wire_motor", near, 1.0, joint))


def _at_every_joint(*calls: Callable[[int], Call]) -> Callable[[int], Calls]:
    return lambda number: tuple(call(joint) for joint in range(JOINTS) for call in calls)


FAULTS = (
    Fault(
        "pot-swapped", "pot", "Two joints' wires exchanged",
        "the wires of this potentiometer and of the next joint's are exchanged", "calibrate",
        "<first> reads .* and did not move, but .<second> did: their wires are swapped",
        lambda pot: (("swap", pot, _near(pot)),),
    ),
    Fault(
        "arms-swapped", "arm", "Plugs of leader and follower exchanged",
        "the leader's plug is where the follower's belongs, and the other way round",
        "calibrate", "eader potentiometer 0 reads .* but follower potentiometer 0 did: the two arms are swapped",
        _at_every_joint(lambda joint: ("swap", joint, joint + JOINTS)),
    ),
    Fault(
        "pot-reversed", "pot", "Ends of its track exchanged",
        "the two ends of the track are exchanged, so that it reads the other way", "calibrate",
        r'"reversed": \[[^]]*"<id>"', _at_pot(PotFault.REVERSED), ends="mended",
    ),
    Fault(
        "pot-crossed", "pot", "Wiper and 5 V exchanged",
        "the wiper is on 5 V and an end of the track on the pin", "calibrate",
        "<pot> reads .* and hardly changes .* its wiper's wire and an end's are exchanged", _at_pot(PotFault.CROSSED),
    ),
    Fault(
        "pot-open", "pot", "Wiper's wire off",
        "the wiper's wire is off, and a pull-down wins", "doctor",
        "<pot> reads 0..0 of 1023, at a rail", _wire(Wiring.OPEN),
    ),
    Fault(
        "pot-floating", "pot", "Wiper's wire off, and no pull-down",
        "the wiper's wire is off, and nothing pulls the pin down", "doctor",
        "These read alike: .*<pot>", lambda pot: (("let_float", pot, True),),
    ),
    Fault(
        "pot-shorted", "pot", "Wiper's wire touches 5 V",
        "the wiper's wire touches 5 V", "doctor",
        "<pot> reads 1023..1023 of 1023, at a rail", _wire(Wiring.SHORTED),
    ),
    Fault(
        "pot-touching", "pot", "Wire touches the next joint's",
        "the wiper's wire touches that of the next joint", "doctor",
        "These read alike: .<first> and .<second>", lambda pot: (("touch", pot, _near(pot)),),
    ),
    Fault(
        "pot-loose", "pot", "Loose wire",
        "the wiper's wire is off for 2 ms again and again", "doctor",
        r"Readings jumped: .<pot> \d+ times", _at_pot(PotFault.LOOSE),
    ),
    Fault(
        "pot-noisy", "pot", "Wire beside a motor's",
        "the wiper's wire runs along a motor's", "doctor",
        r"Noisy, in counts rms: .<pot> \d", _at_pot(PotFault.NOISY),
    ),
    Fault(
        "pot-humming", "pot", "Mains hum",
        "the mains reach the wiper's wire", "doctor",
        r"Mains hum: .<pot> \d.* counts at 50 Hz", _at_pot(PotFault.HUMMING), ends="noted",
    ),
    Fault(
        "pot-dead-zone", "pot", "Dead zone within the range",
        "the track is mounted so that its dead zone lies within the joint's range", "calibrate",
        "<pot> jumps from one end of its track to the other .* its dead zone lies there", _at_pot(PotFault.DEAD_ZONE),
    ),
    Fault(
        "pot-slipping", "pot", "Shaft slips",
        "its shaft slips and loses a part of every way up", "calibrate",
        r"<pot> (reads? \d+|reaches an end|turned the other way|\(by \d+ counts\))", _at_pot(PotFault.SLIPPING),
    ),
    Fault(
        "pot-frozen", "pot", "Shaft does not turn",
        "its shaft does not turn with the joint", "calibrate",
        "<pot> reads .* and did not move: check that its shaft", _at_pot(PotFault.FROZEN),
    ),
    Fault(
        "motor-swapped", "motor", "Two motors exchanged",
        "this motor and the next joint's are on each other's drivers", "calibrate",
        "the motor of joint <low> moved joint <high>: their motors, or .* are swapped", _swap_motors,
    ),
    Fault(
        "motor-reversed", "motor", "Turns the other way",
        "both wires of the motor are exchanged", "calibrate",
        r'"joint": <joint>, "sign": -1', _motor(-1.0), ends="mended",
    ),
    Fault(
        "motor-weak", "motor", "Weak motor",
        "the motor or its driver gives a fifth of its torque", "calibrate",
        "The motor of joint <joint> moved it by .* mrad a volt, .* it is weak", _motor(WEAK_GAIN), ends="noted",
    ),
    Fault(
        "motor-dead", "motor", "A wire of the motor off",
        "a wire of the motor is off", "calibrate",
        "the motor of joint <joint> did not move it", _motor(0.0),
    ),
    Fault(
        "no-supply", "arm", "Motors' supply off",
        "the motors' supply is off", "calibrate",
        "the motor of joint 0 did not move it with .* check that the motors' supply is on",
        _at_every_joint(lambda joint: ("wire_motor", joint, 0.0, joint)),
    ),
    Fault(
        "wrong-supply", "arm", f"Supply of {OTHER_SUPPLY_V:g} V",
        f"the motors' supply has {OTHER_SUPPLY_V:g} V, and the board counts on another one",
        "doctor", "The board counts on 15 V for the motors, not 24 V",
        lambda number: (("change_supply", OTHER_SUPPLY_V),), options=("--supply", f"{OTHER_SUPPLY_V:g}"),
    ),
    Fault(
        "brown-out", "arm", "Supply sinks when a motor draws",
        "the board lives on the motors' supply, which sinks when a motor draws", "calibrate",
        "restarted while the motor of joint 0 was driven", lambda number: (("share_supply",),),
    ),
)  # fmt: skip
BY_NAME = {fault.name: fault for fault in FAULTS}


def facts(fault: Fault) -> dict[str, str]:
    """A fault for a list from which a person chooses."""
    return {"name": fault.name, "group": GROUPS[fault.on], "title": fault.title, "description": fault.says}


def inject(bench: Bench, words: str) -> str:
    """Stage NAME or NAME:PLACE, or take all back (`none`); a sentence says what was done. Raises UserError."""
    name, _, where = words.partition(":")
    if words == NOTHING:
        bench.mend()
        return "every mistake is taken back."
    if name not in BY_NAME:
        raise UserError(f'"{name}" is no mistake; there are: {", ".join(BY_NAME)}, and {NOTHING}.', 2)
    fault = BY_NAME[name]
    place = where or USUAL[fault.on]
    if place not in WHERE[fault.on]:
        places = WHERE[fault.on]
        remedy = f"say {name}:{places[0]} to {name}:{places[-1]}" if places[0] else f"say {name} alone"
        raise UserError(f'"{where}" is no place for {name}; {remedy}.', 2)
    for method, *given in fault.calls(WHERE[fault.on].index(place)):
        getattr(bench, str(method))(*given)
    return f"{place}{': ' if place else ''}{fault.says}."


def listed() -> str:
    """All mistakes, a line each."""
    return "\n".join(f"{_usage(one):<28} {one.says[:1].upper()}{one.says[1:]}." for one in FAULTS)


def markdown_table() -> str:
    """The table on the site's page of `greywhale sim`."""
    rows = ["| mistake | what is wrong | found by |", "|---|---|---|"]
    found = {"refused": "", "mended": ", which puts it right", "noted": ", as a note"}
    for one in FAULTS:
        verb = " ".join((one.verb, *one.options))
        rows.append(f"| `{_usage(one)}` | {one.says} | `{verb}`{found[one.ends]} |")
    return "\n".join(rows)


def _usage(fault: Fault) -> str:
    return f"{fault.name}{ {'pot': ':leader0', 'motor': ':0', 'arm': ''}[fault.on] }"
