"""Writes the data of the tuner inside a page: motions and their weights, the arm and its variants, the search.

All of it is what `greywhale tune default --force` searches with, but for the motions: the page has straight lines
between their rows, rounded to SCALE_RAD. host/native/web takes the numbers.
"""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

import numpy as np

from greywhale.arm import PotentiometerBank
from greywhale.arm.parameters import ArmParameters
from greywhale.arm.plants import plant_row
from greywhale.base.limits import numbers_in
from greywhale.base.types import Floats
from greywhale.dashboard import predict
from greywhale.files.arm import load_arm
from greywhale.files.trajectory import Trajectory
from greywhale.fuzzy.settings import LEAST_WIDTH, SET_UNIT
from greywhale.loop.closed_loop import Timing, settings_numbers, with_right_motors
from greywhale.loop.leader import SLICE_S, straight_slices
from greywhale.loop.leader_motions import RATE_HZ
from greywhale.measure import swings
from greywhale.measure.runs import stretches
from greywhale.optimise import shift_invariant
from greywhale.optimise.optimiser import PACK
from greywhale.protocol.firmware import JOINTS, pwm_steps
from greywhale.protocol.schema import Board
from greywhale.protocol.table import CONTROLLER_COLUMNS
from greywhale.tune import default, possible
from greywhale.tune.judge import margins
from greywhale.tune.limits import TUNING_LIMITS as LIMITS
from greywhale.tune.model import Model, load_model
from greywhale.tune.search import space, training
from tools.site.bench_data import pot_numbers

SCALE_RAD = 1e-5
APART = round(1.0 / RATE_HZ / SLICE_S)  # slices between two rows
BUDGET = 500
SEED = 0
SHOWN = 1  # the class of motions that a person sees: human-like reaches


def packed(rows: Floats) -> list[list[int]]:
    """Of each joint its steps from row to row in SCALE_RAD, the first from 0; after each 0 comes how many there are."""
    joints = []
    for steps in np.diff(np.rint(rows / SCALE_RAD).astype(int), axis=0, prepend=0).T:
        numbers: list[int] = []
        for step in map(int, steps):
            if step == 0 and len(numbers) > 1 and numbers[-2] == 0:
                numbers[-1] += 1
            else:
                numbers += [step] if step else [0, 1]
        joints.append(numbers)
    return joints


def page_slices(motion: Trajectory, wait_s: float) -> Floats:
    """The angles (rad) in every slice as a page has them."""
    rows = np.rint(motion.angles / SCALE_RAD) / round(1.0 / SCALE_RAD)
    return straight_slices(rows, APART, wait_s)


def tuner_data() -> dict[str, Any]:
    """All of it, as the page reads it."""
    model = default.give_usual_noise(load_model("default", force=True))
    board = with_right_motors(model.table)
    return {
        "settings": numbers_of(settings_numbers(board).values()),
        "timing": [_timing(Timing()), _timing(Timing(late=model.period_ms))],
        "leader_pots": pot_numbers(model.arm.leader_pots),
        "follower_pots": pot_numbers(model.arm.follower_pots),
        "motion": {
            "scale": round(1.0 / SCALE_RAD),
            "apart": APART,
            "wait_s": training.WAIT_S,
            "soon_s": LIMITS.training.soon_s,
        },
        "plant": model.plants[0].tolist(),
        "drills": _drills(model),
        "shown": SHOWN,
        "rests": {
            "searching": _rests(
                model, LIMITS.margins.rest_s, 0, LIMITS.margins.search_beyond, LIMITS.swings.search_cycle
            ),
            "refining": _rests(
                model, LIMITS.margins.long_rest_s, 0, LIMITS.margins.search_beyond, LIMITS.swings.search_cycle
            ),
            "judging": _rests(model, LIMITS.margins.long_rest_s, 1, 1.0, LIMITS.swings.limit_cycle),
        },
        "limits": _limits(model.table.supply_v),
        "predicted": _predicted(load_arm("default")),
        "search": _search(model),
    }


def numbers_of(values: Any) -> list[float]:
    """Numbers and sequences of numbers one after the other."""
    return [float(one) for value in values for one in (value if isinstance(value, Sequence) else [value])]


def _timing(timing: Timing) -> list[float]:
    return numbers_of([timing.chain_start, timing.acts, timing.drivers_on, timing.late])


def _noise(seed: int) -> dict[str, Any]:
    """An experiment's seeds, of the leader's noise and the follower's, and where its gears stand in their gaps."""
    return {"seeds": [seed, seed + 1], "gaps": np.random.default_rng(seed).uniform(-1.0, 1.0, JOINTS).tolist()}


def _predicted(arm: ArmParameters) -> dict[str, Any]:
    """The arm and the motions of a prediction, as `greywhale.dashboard.predict` has them."""
    return {
        "plant": plant_row(arm).tolist(),
        "leader_pots": pot_numbers(quiet(arm.leader_pots)),
        "follower_pots": pot_numbers(quiet(arm.follower_pots)),
        "motions": {name: packed(rows) for name, rows in predict.motions().items()},
        "noise": _noise(predict.SEED),
        "wait_s": predict.BEFORE_S,
        "every": predict.ROW_EVERY_TICKS,
        "pwm_tops": {str(int(board)): pwm_steps(board) for board in Board},
    }


def quiet(bank: PotentiometerBank) -> PotentiometerBank:
    """These potentiometers without noise."""
    return bank.model_copy(update={"joint": tuple(pot.model_copy(update={"noise": 0.0}) for pot in bank.joint)})


def _drills(model: Model) -> list[dict[str, Any]]:
    motions = training.training_motions(model.arm, model.table, model.plants, SEED)
    floors = possible.scale_of(motions, model.plants, model.controllers).floor[0]
    drills = []
    for number, (drill, floor) in enumerate(zip(motions, floors, strict=True)):
        _, moving = training.moving_ticks(drill.motion, training.WAIT_S)
        drills.append(
            {
                "name": drill.name,
                "steps": packed(drill.motion.angles),
                "searching": _noise(training.noise_seed(SEED, number)),
                "judging": _noise(training.noise_seed(SEED + default.JUDGING_SEED, number)),
                # None where all ticks weigh the same.
                "moving": None if drill.name == training.SLOW else stretches(moving),
                "total_weight": drill.total_weight,
                "importance": drill.importance,
                "first_block": swings.first_block(training.WAIT_S),
                "floor": floor.tolist(),
            }
        )
    return drills


def _rests(model: Model, rest_s: float, noise: int, beyond: float, cycle: swings.Hunting) -> dict[str, Any]:
    motion = margins.stops(*training.reach(model.arm, model.table, model.plants), rest_s)
    return {
        "steps": packed(motion.angles),
        "noise": _noise(margins.noise_seed(SEED, noise)),
        "ticks": margins.rest_ticks(rest_s),
        "variants": [rows[0].tolist() for rows in margins.variants_of(model.plants, beyond).values()],
        "band": cycle.band_rad,
        "turns": cycle.turns,
    }


def _limits(supply_v: float) -> list[float]:
    """In the order of Limits in host/native/web/score.cpp."""
    groups = [numbers_in(group) for group in (LIMITS.cost, LIMITS.swings, LIMITS.margins, LIMITS.choice)]
    return [*np.concatenate([swings.FOR_SIMULATIONS, *groups]).tolist(), supply_v]


def _search(model: Model) -> dict[str, Any]:
    whole = space.Space.default("both", model.controllers, model.table["supply_mv"], model.period_ms)
    reduced = whole.reduce()
    return {
        "budget": BUDGET,
        "pack": PACK if BUDGET < default.SHORT_BUDGET else default.FULL_PACK,
        "a": shift_invariant.A_FACTOR,
        "weights": shift_invariant.LEADER_WEIGHTS,
        "keep": shift_invariant.KEEP_PROBABILITY,
        "stages": [
            {
                "name": stage.name,
                "share": stage.share,
                "sigma": stage.sigma,
                "space": "whole" if stage.every_corner else "reduced",
                "groups": [list(group) for group in stage.groups],
                "random": [_state(SEED, number, joint) for joint in range(JOINTS)],
            }
            for number, stage in enumerate(default.STAGES, 1)
        ],
        "spaces": {"whole": _space(whole), "reduced": _space(reduced)},
        "calmer": LIMITS.choice.gain_reductions,
        "ku": default.KU,
        "ki": default.KI,
        "least_width": LEAST_WIDTH,
        "set_unit": SET_UNIT,
        # What the reduced space holds fast, and the sets that stretch in its place.
        "stretch": [
            {
                "column": CONTROLLER_COLUMNS.index(gain.lower()),
                "raw": int(reduced.base[0, CONTROLLER_COLUMNS.index(gain.lower())]),
                "sets": [CONTROLLER_COLUMNS.index(name.lower()) for name in sets],
            }
            for gain, sets in (("Kp", space.SETS[:4]), ("Kd", space.SETS[4:]))
        ],
    }


def _space(of: space.Space) -> list[dict[str, Any]]:
    return [
        {
            "column": one.column,
            "mirror": CONTROLLER_COLUMNS.index(one.mirror.lower()) if one.mirror else None,
            "unit": one.unit,
            "sign": -1 if one.high <= 0.0 else 1,
            "is_set": one.name in space.SETS,
            "logarithmic": one.logarithmic,
            "offset": one.offset,
            "bounds": one.bounds,
        }
        for one in of.variables
    ]


def _state(*seed: int) -> list[str]:
    """State and increment of numpy's PCG64 from a seed, hexadecimal."""
    state: Any = np.random.PCG64(seed).state
    return [f"{state['state'][name]:x}" for name in ("state", "inc")]
