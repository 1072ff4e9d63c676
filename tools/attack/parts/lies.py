"""Measures how far the arm goes before anybody knows of a slow lie, or of two faults at once."""

from __future__ import annotations

from functools import partial

from greywhale_sim.wiring import BOARDS
from tools.attack.arm_faults import Trial, arm_at_work, begin, suffer
from tools.attack.arm_on_board import ArmOnBoard
from tools.attack.copies import in_a_copy
from tools.attack.load import Watch
from tools.attack.part import STAYED_ON, Part, Piece, Row, split
from tools.attack.parts import faults
from tools.attack.pot_lies import Inject
from tools.attack.slow_lies import slow_lies

MOMENTS, PER_PIECE = 40, 5
PATIENCE_S = 3.0
FAR = "far"


def try_lie(arm: ArmOnBoard, inject: Inject, joint: int) -> tuple[Trial, float]:
    """A trial, and the load (V) under which an honest joint would look the same to the board."""
    watch = Watch(arm)
    trial = suffer(arm, inject, joint, PATIENCE_S, watch.note)
    return trial, watch.load_v(joint)


def count(board: str, name: str, known: str, trial: Trial, load_v: float) -> Row:
    seen = {trial.fault if trial.off_ms is not None else STAYED_ON: 1}
    if trial.wrong_rad > faults.FARTHEST_RAD:
        seen[FAR] = 1
    return Row(f"{board}: {name}, {known}", 1, 0, seen, {"rad": round(trial.wrong_rad, 2), "V": round(load_v, 1)})


def run(piece: Piece) -> list[Row]:
    """At each moment every lie in a copy of its own."""
    arm, known = arm_at_work(piece["board"], piece["seed"])
    rows = []
    for moment in range(piece["trials"]):
        begin(arm)
        for name, inject in slow_lies().items():
            if name in piece.get("faults", slow_lies()):
                trial, load_v = in_a_copy(partial(try_lie, arm, inject, moment % 4))
                rows.append(count(piece["board"], name, known, trial, load_v))
    return rows


def pieces(share: float) -> list[Piece]:
    return [piece for board in BOARDS for piece in split(MOMENTS, share, PER_PIECE, board=board)]


PART = Part(
    "lies",
    "Slow lies, and two faults at once",
    f"""Nothing is promised here: the board finds these lies late or never. All is as for the faults above, with
        {MOMENTS} moments, half of them with the tuned controllers and `tune`'s numbers of travel, and {PATIENCE_S:g} s
        from each. `rad` is the greatest way by which the true error has grown (the first rows show the lag with nothing
        wrong); `{FAR}` counts the trials with more than {faults.FARTHEST_RAD} rad. `V` is the load, in volts at the
        motor, under which an honest joint would show the same, 95 % of the time: where a hand's hold shows as much, no
        check can tell the lie from the hand. A reading that drifts, or loses gain slowly, is followed; one that comes
        late, or turns too little, lets the joint overshoot. A joint whose frozen reading holds it back stands still,
        but with its motor reversed too, what should hold it against gravity drives it. Keep the emergency stop at hand,
        and look at the arm.""",
    (*faults.PART.depends, "tools/attack/load.py", "tools/attack/slow_lies.py", "tools/attack/parts/faults.py"),
    pieces,
    run,
)
