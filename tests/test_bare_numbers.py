"""No bare number stands where a limit belongs: the numbers of a room that judges are limits, or have a reason here."""

from __future__ import annotations

import ast
from collections.abc import Iterator

import pytest

from tests.test_structure import SOURCE

ROOMS = ("adapt", "arm", "board", "commission", "dashboard", "files/log", "identify", "measure", "tune")
# Numbers of the host in 1000 lines of it, whatever they are for: the fewest that there were. Fewer are better.
MOST_IN_1000_LINES = 7.6
GENERATED = {"board/flash/rules.py"}  # from shared, where each number has its reason
# Numbers that are no judgement, and why.
COUNTS = "how much is computed: more would only take longer"
SEED = "a seed of random numbers"
ASKED = "what a person asks for"
PAPER = "the paper's own setting or figures"
ROUNDING = "keeps a division from 0"
DRAWN = "how a motion is drawn and played"
FINE = "how finely something is computed"
BOARD = "of the board or its converter"
DEFINITION = "defines a measure"
FORMAT = "of a format"
UNIT = "what a unit counts"
SHOWN = "how much is shown or told at once"
LOOKS = "how often something is looked for"
CHUNK = "how many rows are in memory at once"
ALLOWED = {
    "adapt/background.py": {"NICENESS": "the system's priority of a process"},
    "adapt/change.py": {"SOFT_START_MS": "the shortest that the firmware takes"},
    "adapt/gain.py": {"LEAST_GROUPS": "where the table of Student's t begins", "T_99": "a table of Student's t"},
    "adapt/run.py": {"BUDGET": ASKED, "SECONDS": ASKED},
    "adapt/stretch.py": {"LENGTH_S": "the unit in which an adaptation counts"},
    "arm/export.py": {"_AXES": "of the joints", "_TEETH_IMPEDANCE": "the stiffness of teeth"},
    "arm/fewer_joints.py": dict.fromkeys(("NOTHING_KG", "NOTHING_KG_M2", "SHORTEST_M"), "of a link that is not there"),
    "arm/from_urdf.py": {"ROUNDING_M": ROUNDING},
    "arm/make/assemble.py": dict.fromkeys(("MM", "GRAM", "GRAM_CM2"), UNIT),
    "arm/make/form.py": {"LONGEST_ANSWER_LETTERS": SHOWN},
    "arm/make/questions.py": {"G_CM2_PER_KG_M2": UNIT, "_LENGTHS_MM": ASKED},
    "arm/parameters.py": {"PITCH_JOINTS": "the joints' numbers", "PAPER_IYY0": PAPER},
    "arm/plant.py": {"LONGEST_STEP_S": FINE},
    "board/device.py": {"_UNASKED_SEQ": FORMAT},
    "board/doctor/board.py": {"_MOST_SHOWN": SHOWN},
    "board/flash/boot_code.py": dict.fromkeys(("_READS_CAUSE", "_ANY_REGISTER"), BOARD),
    "board/flash/question.py": dict.fromkeys(("ANY", "KEPT"), "stand for a byte"),
    "board/flash/runner.py": {"GRACE_S": "for a tool to end by itself; no board is judged"},
    "board/meeting.py": {"NAMES_PER_PORT": "any user may take some of them first"},
    "board/pots.py": {"LOOK_SAMPLES": COUNTS},
    "board/record.py": {"_ROWS_PER_REPORT": LOOKS},
    "board/session.py": {"_WAKE_S": LOOKS},
    "board/stream.py": {"_TICK_COUNTS": BOARD},
    "board/upload.py": {"_POLL_S": LOOKS},
    "commission/arm_on_port.py": {"TRIES": "repeats where this computer was too busy; the arm is not judged"},
    "commission/foresee.py": {"SEED": SEED, "LEAST": ROUNDING},
    "commission/measures.py": {"LATEST_BEGIN_S": "how far the beginning of the check is looked for in its log"},
    "commission/motions.py": {"REACHES_SEED": SEED},
    "commission/request.py": {"ROUNDS": ASKED, "TRIALS": ASKED},
    "commission/search.py": {"LEAST_RAD2": ROUNDING},
    "dashboard/access.py": {"_SECRET_BYTES": "of a token or a ticket: nobody guesses 192 bits"},
    "dashboard/client.py": {"_REQUEST_NUMBERS": FORMAT},
    "dashboard/connections.py": {"_AGAIN_S": LOOKS, "_ROOT": "the system's number of a user"},
    "dashboard/predict.py": {
        **dict.fromkeys(("STEP_RAD", "REACH_RAD", "REACH_S", "BEFORE_S", "AFTER_S"), DRAWN),
        **dict.fromkeys(("DIGITS", "ROW_EVERY_TICKS"), FINE),
        "SEED": SEED,
    },
    "dashboard/relay.py": {"_STATE": FORMAT},
    "files/log/condition.py": {"_MOST_NAMED_GAPS": SHOWN},
    "files/log/episodes.py": {"DIGITS": FORMAT},
    "files/log/held.py": {"_PER_UNIT": FORMAT},
    "files/log/layout.py": {"TIME_DIGITS": FORMAT},
    "files/log/writer.py": dict.fromkeys(("_VALUE_ROOM", "_REASON_ROOM"), FORMAT),
    "identify/bootstrap.py": {"LOGS": COUNTS, "STEPS": COUNTS, "MOMENTS": BOARD},
    "identify/closed_loop.py": {
        **dict.fromkeys(("COMPARED_TICKS", "STEPS_PER_TICK", "BENCH_STEPS"), FINE),
        "SEED": SEED,
    },
    "identify/data.py": {
        **dict.fromkeys(("ACTUATION_S", "CONVERSION_S"), BOARD),
        "STEP_S": FINE,
    },
    "identify/default.py": {"DRAWS": COUNTS},
    "identify/excite/design.py": {
        **dict.fromkeys(("BUDGET", "MOST_BUDGET", "SECONDS"), ASKED),
        **dict.fromkeys(("GOOD_BUDGET", "SHRINKS"), COUNTS),
    },
    "identify/excite/information.py": {"_STEP": FINE},
    "identify/excite/limits.py": {"FARTHEST_RAD": ASKED, "FAMILY": COUNTS},
    "identify/excite/multisine.py": {"SINES": DRAWN, "SHORTEST_S": ASKED, "LONGEST_S": ASKED},
    "identify/excite/trial.py": dict.fromkeys(("EVERY", "STEPS_PER_TICK", "STILL_TICKS"), FINE),
    "identify/fit.py": {"TOLERANCE": FINE},
    "identify/judge.py": {"TINY": ROUNDING},
    "identify/overlap.py": {"_RUN": "of a hash of rows", "_FACTOR": "of a hash of rows"},
    "identify/pack_search.py": {"AGENTS": PAPER, "ITERATIONS": PAPER},
    "identify/paper.py": {"LEAST": PAPER, "UPPER": PAPER},
    "identify/samples.py": {"EVERY": COUNTS},
    "identify/search.py": {
        **dict.fromkeys(("SOME_WINDOWS", "WINDOW_STEPS", "PROBE_STEPS", "ROUNDS", "LOOP_STEPS"), COUNTS),
        **dict.fromkeys(("SETTLINGS", "SETTLED_STEPS", "FITS", "SURE_TURNS"), COUNTS),
        "LOOP_STEP_SCALE": FINE,
    },
    "identify/space.py": {"COUPLED": "the joints' numbers"},
    "identify/steps.py": dict.fromkeys(("DAMPINGS", "LARGEST_STEP", "MOST_DAMPING", "ENOUGH"), FINE),
    "identify/soft_teeth.py": {"SWINGS_HZ": FINE},
    "identify/uncertainty.py": {"LARGEST_CONDITION": ROUNDING},
    "identify/windows.py": {"SIDES": FINE, "START_PASSES": FINE},
    "measure/delay.py": {"_PIECE": CHUNK},
    "measure/repeatability.py": {"SPREAD": DEFINITION},
    "measure/runs.py": {"_PART": CHUNK, "REST_S": DEFINITION, "REST_RAD": DEFINITION},
    "measure/swings.py": {
        **dict.fromkeys(("MEAN_S", "RATTLE_BAND_HZ", "CHATTER_SHARE", "RIPPLE_S", "END_S", "JUMP_S"), DEFINITION),
        **dict.fromkeys(("REST_AFTER_S", "STILL_RAD", "SHORTEST_REST_S", "BLOCK_S", "REACT_S"), DEFINITION),
        "FILTER_EVERY": FINE,
    },
    "tune/default.py": {
        "BUDGET": ASKED,
        "SEARCH_PLANTS": COUNTS,
        "FULL_PACK": COUNTS,
        "SHORT_BUDGET": COUNTS,
        "JUDGING_SEED": SEED,
    },
    "tune/judge/held_out.py": {"WAIT_S": DRAWN, "SEED": SEED, "EVERY": DRAWN},
    "tune/judge/margins.py": {"_MOVING_SEED": SEED},
    "tune/model.py": {"SAMPLES": ASKED, "MOST_SAMPLES": ASKED},
    "tune/model_checks.py": {
        "SPREAD_SAMPLES": COUNTS,
        "ONE_BY_ONE_SAMPLES": COUNTS,
        "REACHES_SEED": SEED,
        "REACHES_S": DRAWN,
        "WAIT_TICKS": DRAWN,
        "CERTAIN": ROUNDING,
    },
    "tune/paper.py": dict.fromkeys(("AGENTS", "ITERATIONS", "PERIOD_MS", "LARGEST_SUPPLY_V", "WAIT_S"), PAPER),
    "tune/report/tables.py": dict.fromkeys(
        ("PAPER_STEP_MSE", "PAPER_STEADY_STATE", "PAPER_DELAY", "PAPER_MULTI_STEP_MSE"), PAPER
    ),
    "tune/run.py": {"MOST_BUDGET": ASKED},
    "tune/search/lockstep.py": {"TURNS": "the joints' numbers", "RANKS": COUNTS},
    "tune/search/training.py": {"WAIT_S": DRAWN, "HUMAN_SEED": SEED},
    "tune/travel.py": {"SAMPLES": COUNTS, "SEED": SEED},
}


def is_numeric(node: ast.expr) -> bool:
    """Whether an expression is made of numbers alone: 0.3, -1, 1 << 16, (0.1, 0.2)."""
    if isinstance(node, ast.Constant):
        return isinstance(node.value, int | float) and not isinstance(node.value, bool)
    if isinstance(node, ast.Tuple | ast.List):
        return bool(node.elts) and all(map(is_numeric, node.elts))
    if isinstance(node, ast.UnaryOp):
        return is_numeric(node.operand)
    return isinstance(node, ast.BinOp) and is_numeric(node.left) and is_numeric(node.right)


def numbers(target: ast.expr, value: ast.expr) -> Iterator[str]:
    """The names that an assignment gives to numbers; those of `A, B = 1, 2` one by one."""
    if isinstance(target, ast.Name) and is_numeric(value):
        yield target.id
    elif isinstance(target, ast.Tuple) and isinstance(value, ast.Tuple):
        for one, other in zip(target.elts, value.elts, strict=False):
            yield from numbers(one, other)


def constants(text: str) -> list[str]:
    """The names of a module's numbers."""
    found = []
    for node in ast.parse(text).body:
        if isinstance(node, ast.Assign):
            found += [name for target in node.targets for name in numbers(target, node.value)]
        elif isinstance(node, ast.AnnAssign) and node.value is not None:
            found += list(numbers(node.target, node.value))
    return found


def test_a_modules_numbers_are_found() -> None:
    assert constants("A = 1\nB: float = -0.5\nC, D = 2, 'x'\nE = (1, 2)\nF = A\nG = f(3)\ndef h():\n    K = 4\n") == [
        *"ABCE"
    ]


@pytest.mark.parametrize("room", ROOMS)
def test_no_bare_number_stands_where_a_limit_belongs(room: str) -> None:
    """If one does: a judgement becomes a field of the room's limits.py; what is none gets a reason above."""
    bare, used = [], set()
    for path in sorted((SOURCE / "greywhale" / room).rglob("*.py")):
        where = str(path.relative_to(SOURCE / "greywhale"))
        if where in GENERATED:
            continue
        for name in constants(path.read_text(encoding="utf-8")):
            used.add((where, name))
            if not where.startswith((f"{room}/limits.py", f"{room}/limits/")) and name not in ALLOWED.get(where, {}):
                bare.append(f"{where}: {name}")
    assert bare == []
    allowed = {(where, name) for where, names in ALLOWED.items() if where.startswith(f"{room}/") for name in names}
    assert allowed - used == set(), "these numbers are gone"


def test_the_host_has_no_more_bare_numbers_than_before() -> None:
    """If it has: inline what says no more than its expression, derive it from another, or give it to the limits."""
    texts = [path.read_text(encoding="utf-8") for path in (SOURCE / "greywhale").rglob("*.py")]
    lines = sum(len(text.splitlines()) for text in texts)
    assert 1000 * sum(len(constants(text)) for text in texts) / lines <= MOST_IN_1000_LINES
