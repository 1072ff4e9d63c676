"""The questions about an arm, one at a time, with unit, range and usual value; for a person or a file."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from typing import Any, Protocol

from greywhale.arm.limits import GUESSES
from greywhale.arm.make.body import MATERIALS
from greywhale.arm.make.motor import RAD_S_PER_RPM, contradiction
from greywhale.arm.parameters import JOINT_NAMES
from greywhale.base.errors import UserError
from greywhale.base.formats import units
from greywhale.base.formats.units import Unit
from greywhale.protocol.joints import ALL, Joints, listed, parse

G_CM2_PER_KG_M2 = 1e7  # data sheets have the first, arm files the second
SAME_MOTOR = "same_motor"
JOINTS_IN_USE = "joints"
MOTOR_KEYS = (
    *("rated_v", "gear_ratio", "stall_torque_nm", "stall_current_a", "no_load_rpm", "no_load_current_a"),
    "rotor_inertia_gcm2",
)
_USUAL_MOTOR = {"gear_ratio": 100.0, "stall_torque_nm": 1.5, "stall_current_a": 2.0, "no_load_rpm": 60.0}


@dataclass(frozen=True)
class Question:
    """A number, or one of `choices`. `table` and `key` are where an answers file has it: [[link]] length_mm."""

    table: tuple[str, int] | None
    key: str
    text: str
    usual: float | str
    unit: Unit = units.PLAIN
    low: float = 0.0
    high: float = 0.0
    choices: Sequence[str] = ()
    free: bool = False  # any text will do
    check: Callable[[Any], str] = lambda value: ""  # why a value cannot be, "" if it can; of a free text too

    @property
    def where(self) -> str:
        """The key as a sentence names it: link[1].length_mm."""
        return self.key if self.table is None else f"{self.table[0]}[{self.table[1]}].{self.key}"

    def read(self, given: object) -> float | str:
        """The answer in the question's unit. Raises ValueError with the reason."""
        if self.free:
            if reason := self.check(str(given)):
                raise ValueError(reason)
            return str(given).strip()
        if isinstance(given, str) and given.strip().lower() in self.choices:
            return given.strip().lower()
        if isinstance(given, bool) or not isinstance(given, int | float | str):
            raise ValueError("that is no number")
        if self.choices and not self.high:
            raise ValueError(f"say one of: {', '.join(self.choices)}")
        try:
            value = units.read_number(str(given), self.unit)
        except ValueError as error:
            choices = f"; or say one of: {', '.join(self.choices)}" if self.choices else ""
            raise ValueError(f"{error}{choices}") from None
        if not self.low <= value <= self.high:
            span = f"{units.shown(self.low, units.PLAIN)} to {units.shown(self.high, self.unit)}"
            raise ValueError(f"it must be {span}")
        if reason := self.check(value):
            raise ValueError(reason)
        return value


class Source(Protocol):
    """A person, asked again until an answer will do, or a file of answers."""

    def heading(self, text: str) -> None: ...
    def ask(self, question: Question) -> float | str: ...


Answers = dict[str, Any]

LINKS = (
    "Link 0, the turret: what turns about the vertical, from its bearing up to the shoulder's axis.",
    "Link 1, the upper arm: from the shoulder's axis to the wrist pitch's axis.",
    "Link 2, the wrist: from the wrist pitch's axis to the roll's bearing.",
    "Link 3, the hand: from the roll's bearing to its tip.",
)
_LENGTHS_MM = (80.0, 140.0, 50.0, 120.0)  # usual ones of links 0..3


def collect(source: Source) -> Answers:
    """All answers, in the questions' units, laid out as in an answers file."""
    source.heading("The arm")
    answers: Answers = {
        "name": source.ask(Question(None, "name", "What is the arm called", "my arm", free=True)),
        "supply_v": source.ask(Question(None, "supply_v", "The motors' supply", 12.0, units.VOLT, 1.0, 60.0)),
    }
    answers["link"] = []
    for number in range(len(JOINT_NAMES)):
        source.heading(LINKS[number])
        answers["link"].append(_link(source, number))
    load = Question(None, "tip_g", "A load that it carries at the hand's tip", 0.0, units.GRAM, 0.0, 20_000.0)
    answers["tip_g"] = source.ask(load)
    text = "Which joints have a motor and potentiometers (0 to 3; the others are rigid)"
    answers["joints"] = source.ask(Question(None, JOINTS_IN_USE, text, listed(ALL), free=True, check=_check_joints))
    used = read_joints(answers["joints"])
    answers["joint"] = [None] * len(JOINT_NAMES)  # of those that have one
    before = None
    for number in used:
        source.heading(f"Joint {number}, {JOINT_NAMES[number]}: motor and range.")
        known = None if before is None else answers["joint"][before]
        answers["joint"][number] = _joint(source, number, before, known, answers["supply_v"])
        before = number
    source.heading("The potentiometers")
    track = Question(
        None, "track_deg", "How far the track goes, electrically, from end to end", 300.0, units.DEGREE, 180.0, 450.0
    )
    answers["track_deg"] = source.ask(track)
    return answers


def read_joints(given: str) -> Joints:
    """The joints of a list such as 0,1, or [0, 1] as TOML has it. Raises UserError."""
    return parse(given.strip("[] "), "joints")


def _check_joints(given: str) -> str:
    try:
        read_joints(given)
    except UserError:
        return "give one or more of 0 to 3, each once, such as 0,1"
    return ""


def _link(source: Source, number: int) -> Answers:
    at = ("link", number)

    def ask(key: str, text: str, usual: float | str, unit: Unit, low: float, high: float, **more: Any) -> Any:
        return source.ask(Question(at, key, text, usual, unit, low, high, **more))

    found: Answers = {"length_mm": ask("length_mm", "Its length", _LENGTHS_MM[number], units.MM, 5.0, 2000.0)}
    shapes = ("tube", "bar")
    found["section"] = source.ask(Question(at, "section", "Its section, tube (round) or bar", "tube", choices=shapes))
    if found["section"] == "tube":
        outer = found["outer_mm"] = ask("outer_mm", "The tube's outer diameter", 25.0, units.MM, 1.0, 500.0)
        most = outer / 2.0
        text = f"The thickness of its wall ({most:g} mm: a solid rod)"
        found["wall_mm"] = ask("wall_mm", text, min(2.0, most), units.MM, 0.1, most)
    else:
        found["width_mm"] = ask("width_mm", "The bar's width, along the pitch axis", 20.0, units.MM, 0.5, 500.0)
        found["height_mm"] = ask("height_mm", "The bar's height, across it", 20.0, units.MM, 0.5, 500.0)
    found["mass_g"] = ask(
        "mass_g", f"What it weighs alone; or its material ({', '.join(MATERIALS)})", "aluminium", units.GRAM, 0.1,
        50_000.0, choices=tuple(MATERIALS),
    )  # fmt: skip
    found["parts_g"] = ask(
        "parts_g", "Parts mounted on it (the next motor, bearings, gripper), together", 0.0, units.GRAM, 0.0, 50_000.0
    )
    if found["parts_g"]:
        if number == 0:
            text, usual = "How far those are from the vertical axis", 20.0
        else:
            text, usual = "How far those are from the nearer joint's axis", found["length_mm"]
        high = 1000.0 if number == 0 else found["length_mm"]
        found["parts_at_mm"] = ask("parts_at_mm", text, usual, units.MM, 0.0, high)
    return found


def _joint(source: Source, number: int, last: int | None, before: Answers | None, supply_v: float) -> Answers:
    at = ("joint", number)
    same: float | str = "no"
    if before is not None:
        text = f"The same motor and gear as joint {last}"
        same = source.ask(Question(at, SAME_MOTOR, text, "yes", choices=("yes", "no")))
    known = {} if before is None else {key: before[key] for key in MOTOR_KEYS}
    found = known if same == "yes" else _motor(source, at, {"rated_v": supply_v, **_USUAL_MOTOR, **known})
    text = "The lower end of its range (0: all links in line, level)"
    found["min_deg"] = source.ask(Question(at, "min_deg", text, -90.0, units.DEGREE, -360.0, 359.0))
    least = float(found["min_deg"]) + 1.0
    text = "The upper end"
    found["max_deg"] = source.ask(Question(at, "max_deg", text, max(90.0, least), units.DEGREE, least, 360.0))
    return found


def _motor(source: Source, at: tuple[str, int], usual: Answers) -> Answers:
    found: Answers = {}

    def ask(key: str, text: str, unit: Unit, low: float, high: float, **more: Any) -> float:
        best = min(max(usual[key], low), high)
        found[key] = value = source.ask(Question(at, key, text, best, unit, low, high, **more))
        return float(value)

    rated = ask("rated_v", "The voltage for which its data sheet gives the values", units.VOLT, 1.0, 60.0)
    ratio = ask("gear_ratio", "Turns of the motor for one of the joint", units.PLAIN, 0.01, 100_000.0)
    torque = ask("stall_torque_nm", "Stall torque, at the joint", units.NEWTON_METRE, 1e-3, 1000.0)
    text = f"Stall current ({rated:g} V / the winding's resistance)"
    current = ask("stall_current_a", text, units.AMPERE, 1e-3, 500.0)
    fastest = rated * current / torque / RAD_S_PER_RPM
    usual["no_load_rpm"] = float(f"{min(usual['no_load_rpm'], 0.6 * fastest):.2g}")
    text = "Speed without load, at the joint"
    rpm = ask(
        "no_load_rpm", text, units.RPM, 0.01, 1e5,
        check=lambda value: contradiction(torque, current, value * RAD_S_PER_RPM, rated),
    )  # fmt: skip
    usual.setdefault("no_load_current_a", float(f"{GUESSES.no_load_share * current:.2g}"))
    text = "Current without load (a 20th of the stall current is usual)"
    ask("no_load_current_a", text, units.AMPERE, 0.0, 0.5 * current)
    guess = GUESSES.time_constant_s * torque / (rpm * RAD_S_PER_RPM) / ratio**2 * G_CM2_PER_KG_M2
    usual.setdefault("rotor_inertia_gcm2", float(f"{guess:.2g}"))
    text = "The rotor's inertia (seldom told; this guess follows from the rest)"
    ask("rotor_inertia_gcm2", text, units.GRAM_CM2, 1e-6, 1e6)
    return found
