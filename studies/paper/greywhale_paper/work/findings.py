"""What decides whether the paper's figures come out: period, objective, friction, and what motion can show.

A `seed` that draws nothing is taken all the same, as every task has one.
"""

from __future__ import annotations

from typing import Any

import numpy as np

from greywhale.arm.plants import column, plant_row
from greywhale.base.types import Controllers, Floats, show_no_progress
from greywhale.files.arm import load_arm
from greywhale.fuzzy.settings import GAIN_UNIT
from greywhale.identify.closed_loop import Loop
from greywhale.identify.data import prepare
from greywhale.identify.paper import LOWER, UPPER, VALUES, PaperSearch
from greywhale.loop import CONTROLLER_COLUMNS, Experiment, steps
from greywhale.protocol.firmware import JOINTS
from greywhale.tune.model import load_model
from greywhale.tune.paper import AGENTS, BUDGET, METHOD, Loops
from greywhale.tune.search.lockstep import LockstepSearch, SearchState
from greywhale.tune.search.space import Space
from greywhale_paper.work.bench import record_data
from greywhale_paper.work.grey_box import setting, supply_of
from greywhale_paper.work.motions import MOTIONS, WAIT_S, judged, paper_board, play, printed
from greywhale_paper.work.readings import LENGTHS_S

PERIODS_MS = (1, 2, 5, 10, 20, 50)
# Coulomb friction of the joints: none, as much for each, and what Table 11's errors before tuning imply (docs/arm.md).
FRICTION_V = ((0.0,) * 4, (4.0,) * 4, (3.6, 7.0, 4.1, 4.5))
CONTROLLERS = ("before_tuning", "table_8", "table_10")
# Another motor that moves the same: its Kt/R, J r and Kt² r/R are the same.
OTHER = {"inertia": 0.1, "resistance": 0.1, "torque_constant": 0.1, "viscous": 1.0, "gear_ratio": 10.0}
# Of so many arms, a joint that does not reach this speed (rad/s) under the whole supply counts as stuck.
DRAWS, STUCK_RAD_S = 2000, 0.1
STEP = 0.05  # of a logarithm, for differences


def periods(seed: int) -> dict[str, Any]:
    """The paper's grey-box arm with its controllers at other control periods; Kd is scaled with the period."""
    model = load_model("grey_box", force=True)
    controllers = {"before": printed("before_tuning"), "after": printed("table_10")}
    found = {}
    for period in PERIODS_MS:
        _, plant = setting(model, supply_of("mf"))
        found[str(period)] = judged(model.arm, paper_board(supply_of("mf"), period), plant, controllers)
    return found


def friction(seed: int) -> dict[str, Any]:
    """Steps of the paper's grey box with Coulomb friction (V) under the firmware's own controllers."""
    model = load_model("grey_box", force=True)
    found: dict[str, Any] = {}
    for volts in FRICTION_V:
        table, plant = setting(model, supply_of("mf"))
        for joint in range(JOINTS):
            pull = volts[joint] * plant[column("torque_per_volt", joint)]
            plant[column("coulomb", joint)] = plant[column("breakaway", joint)] = pull
        rows = np.stack([printed(name) for name in CONTROLLERS])
        time_s, leader, angles = play(model.arm, table, plant, rows, steps(1.0, 1.0, max(LENGTHS_S)))
        found["/".join(f"{one:g}" for one in volts)] = {
            name: _held(time_s, leader, follower) for name, follower in zip(CONTROLLERS, angles, strict=True)
        }
    return found


def _held(time_s: Floats, leader: Floats, follower: Floats) -> dict[str, list[Any]]:
    """For a record of each length from the step on: the total MSE (rad²), and each joint's last half second (rad)."""
    begin = int(np.argmax(leader[:, 0] > 0.5))
    error = leader - follower
    found: dict[str, list[Any]] = {"mse": [], "steady": []}
    for length in LENGTHS_S:
        held = error[begin : begin + round(length / float(time_s[1] - time_s[0]))]
        last = held[-round(0.5 / float(time_s[1] - time_s[0])) :]
        found["mse"].append(float(np.mean(held**2, axis=0).sum()))
        found["steady"].append(np.abs(last).mean(axis=0).tolist())
    return found


def objective(seed: int) -> dict[str, Any]:
    """What J rewards: the effort's share of it, J of doing nothing, and what a search on moves to both sides finds."""
    before = printed("before_tuning")
    idle = before.copy()
    idle[:, CONTROLLER_COLUMNS.index("ku_mv")] = idle[:, CONTROLLER_COLUMNS.index("ki")] = 0
    model = load_model("grey_box", force=True)
    table, plant = setting(model, supply_of("sf"))
    loops = Loops(model, "sf", before, 1)
    # A multi-step to both sides, all four joints at once, instead of one joint's step.
    both = Experiment(MOTIONS["multi-steps"](), model.arm, table=table, noise=False, wait_s=WAIT_S, soft_start=False)

    def parts(rows: Controllers) -> tuple[Floats, Floats]:
        """ITAE and ITAU, (n, 4) each, for (n, 4, 13)."""
        result = both.run(rows, plant, threads=1)
        return result.itae, result.itau

    rows = {"doing nothing": idle, "before": before, "table_8": printed("table_8"), "table_10": printed("table_10")}
    found: dict[str, Any] = {"J": {}, "share_of_effort": {}}
    for name, row in rows.items():
        itae, itau = parts(row[None])
        found["J"][name] = {
            "one-sided": float(loops.costs(row[None]).sum()),
            "two-sided": float((itae + itau).sum()),
        }
        found["share_of_effort"][name] = float(itau.sum() / (itae + itau).sum())
    best = SearchState.nothing(before)
    search = LockstepSearch(lambda rows: np.add(*parts(rows)), best)
    search.run(Space.paper("sf", before), stage="two-sided", method=METHOD, budget=BUDGET, seed=(seed,), pack=AGENTS)
    found["ku"] = (best.best[:, CONTROLLER_COLUMNS.index("ku_mv")] / 1000.0).tolist()
    found["ki"] = (best.best[:, CONTROLLER_COLUMNS.index("ki")] / GAIN_UNIT).tolist()
    return found


def identifiability(seed: int, seconds: float, period_ms: int) -> dict[str, Any]:
    """What data set 1 can show of the 20 motor values of Table 4, around the white box, by logarithms.

    `rank`: of how many combinations the equation depends. `condition`: of the Fisher information of those. `angle`: how
    far (rad) an arm of other values, but the same combinations, moves elsewhere in the closed loop. `stuck`: the share
    of joints drawn from Table 2's box that hardly move.
    """
    logs, tables = record_data(seconds, period_ms)
    table = tables[0]
    arm = load_arm("white_box")
    loop = Loop(prepare(logs[0], table["filter_shift"]), table, arm)
    search = PaperSearch(arm, [loop], 0, show_no_progress)
    centre = np.array([getattr(joint.motor, name) for joint in arm.joint for name in VALUES])
    twin = centre * np.tile([OTHER[name] for name in VALUES], JOINTS)
    alike = loop.angles(search.plants(np.stack([centre, twin])), threads=1)
    rows = np.tile(plant_row(arm), (2 * 3 * JOINTS, 1))
    for place in range(3 * JOINTS):
        joint, which = divmod(place, 3)
        for row, sign in ((place, 1.0), (place + 3 * JOINTS, -1.0)):
            _scale(rows[row], joint, which, float(np.exp(sign * STEP)))
    twelve = _sensitivity(loop, rows, STEP)
    return {
        "values": len(centre),
        "rank": int(np.linalg.matrix_rank(_combinations_by_values(search, centre), tol=1e-6)),
        "condition": float(np.linalg.cond(twelve.T @ twelve)),
        "factors": OTHER,
        "angle": float(np.abs(alike[1] - alike[0]).max()),
        "stuck": _stuck(search, seed, float(arm.drive.supply)),
    }


def _stuck(search: PaperSearch, seed: int, supply_v: float) -> float:
    """The share of joints, drawn uniformly from Table 2's box, that the whole supply hardly moves."""
    low, high = np.tile(LOWER, JOINTS), np.tile(UPPER, JOINTS)
    plants = search.plants(np.random.default_rng(seed).uniform(low, high, (DRAWS, len(low))))
    speeds = [
        supply_v * plants[:, column("torque_per_volt", joint)] / plants[:, column("damping", joint)]
        for joint in range(JOINTS)
    ]
    return float((np.array(speeds) < STUCK_RAD_S).mean())


def _combinations_by_values(search: PaperSearch, centre: Floats) -> Floats:
    """(12, 20): the change of the logarithms of what the equation holds with those of the motor values."""
    small = 1e-4
    points = centre * np.exp(small * np.vstack([np.eye(len(centre)), -np.eye(len(centre))]))
    names = ("torque_per_volt", "inertia", "damping")
    columns = [column(name, joint) for joint in range(JOINTS) for name in names]
    logs = np.log(search.plants(points)[:, columns])
    return ((logs[: len(centre)] - logs[len(centre) :]) / (2.0 * small)).T


def _sensitivity(loop: Loop, plants: Floats, step: float) -> Floats:
    """(rows x 4, values): how the angles change with the logarithm of each value."""
    angles = loop.angles(plants, threads=1).reshape(len(plants), -1)
    half = len(plants) // 2
    return ((angles[:half] - angles[half:]) / (2.0 * step)).T


def _scale(plant: Floats, joint: int, which: int, factor: float) -> None:
    """Multiply one combination of a joint: the volts that torque, acceleration or speed need, the others as before."""
    if which == 0:  # torque per volt changes, inertia and damping with it, so that their volts stay
        for name in ("torque_per_volt", "inertia", "damping"):
            plant[column(name, joint)] /= factor
    else:
        plant[column(("inertia", "damping")[which - 1], joint)] *= factor


def white_box_at_rest(seed: int) -> dict[str, Any]:
    """The white box under the printed controllers at 20 ms: whether it comes to rest."""
    arm = load_arm("white_box")
    table = paper_board(float(arm.drive.supply))
    rows = np.stack([printed("before_tuning"), printed("table_10")])
    time_s, _, angles = play(arm, table, plant_row(arm), rows, MOTIONS["steps"]())
    rest = time_s > time_s[-1] - 1.0
    swings = np.ptp(angles[:, rest], axis=1)
    return {"swing_before": swings[0].tolist(), "swing_table_10": swings[1].tolist()}
