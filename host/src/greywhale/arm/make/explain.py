"""Explains a question to whoever answers `?`: its meaning, and which answers will do."""

from __future__ import annotations

from greywhale.arm.make.questions import Question
from greywhale.base.formats.units import PLAIN, shown

MEANT = {
    "name": "Any words; they stand on reports and pictures.",
    "supply_v": "What a multimeter shows at the motor drivers, with the motors at rest.",
    "length_mm": "From axis to axis, as the heading says; not the length of the part itself.",
    "section": "A cut across the link: round, or a rectangle.",
    "outer_mm": "Across the tube, from outside to outside.",
    "wall_mm": "Of the tube; half of its diameter is a solid rod.",
    "width_mm": "Across the link, in the direction of the axis about which it pitches.",
    "height_mm": "Across the link and across that axis: up, where the arm is level.",
    "mass_g": "Weigh the link without motors; or name its material, and the mass follows from its size.",
    "parts_g": "All that is screwed to this link: the motor of the next joint counts here.",
    "parts_at_mm": "To the middle of those parts, along the link; of the turret, sideways.",
    "tip_g": "Gripper and what it holds, 0 if nothing.",
    "joints": "The numbers of the joints that move; the others are as if glued.",
    "same_motor": "yes copies all values of that motor.",
    "rated_v": "Data sheets give torque, speed and currents at this voltage; it need not be your supply.",
    "gear_ratio": "131 for 131:1; all stages together, a belt too.",
    "stall_torque_nm": "The torque at which it just stands still, behind the gear; 10 kg cm are 1 N m.",
    "stall_current_a": "What it draws when it is held fast.",
    "no_load_rpm": "The speed without load, behind the gear.",
    "no_load_current_a": "What it draws while it turns freely.",
    "rotor_inertia_gcm2": "Of the motor alone, before the gear. Take the guess where the data sheet is silent.",
    "min_deg": "Where it may turn to at least, counted from the arm stretched out level.",
    "max_deg": "Where it may turn to at most, counted from the arm stretched out level.",
    "track_deg": "Most potentiometers have 300 degrees; their data sheet says electrical angle.",
}


def explain(question: Question) -> str:
    return f"{MEANT[question.key]} {_answers(question)}".rstrip()


def _answers(question: Question) -> str:
    words = [f"Say one of: {', '.join(question.choices)}."] if question.choices else []
    if question.high:
        units = f", also in {', '.join(question.unit.others)}" if question.unit.others else ""
        span = f"{shown(question.low, PLAIN)} to {shown(question.high, question.unit)}"
        words.append(f"{'Or a number' if words else 'A number'}: {span}{units}.")
    return " ".join(words)
