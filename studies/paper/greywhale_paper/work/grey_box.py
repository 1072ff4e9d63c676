"""Section 5.2 on the paper's own grey-box arm: its method of tuning, its printed controllers, and the floor."""

from __future__ import annotations

from typing import Any

from greywhale.arm.plants import column, plant_row
from greywhale.base.types import Floats, show_no_progress
from greywhale.files.arm import load_arm
from greywhale.protocol.table import ParameterTable
from greywhale.tune.judge.floor import saturation_floor
from greywhale.tune.limits import WITHOUT_FLOORS
from greywhale.tune.model import Model, load_model
from greywhale.tune.paper import BUDGET, LARGEST_SUPPLY_V, PaperMethod
from greywhale.tune.request import TuningRequest
from greywhale.tune.result import curves_of
from greywhale.tune.search.journal import TuningJournal
from greywhale_paper.work.arms import STICKY
from greywhale_paper.work.motions import MOTIONS, judged, paper_board, printed

# Strategy -> the table of the paper that prints its result.
STRATEGIES = {"sf": "table_8", "both": "table_9", "mf": "table_10"}


def setting(model: Model, supply_v: float) -> tuple[ParameterTable, Floats]:
    """Board and plant (columns,) of the paper's simulation at a supply."""
    plant = model.plants[0].copy()
    plant[column("supply")] = supply_v
    return paper_board(supply_v), plant


def supply_of(strategy: str) -> float:
    """Where Ku is tuned too the paper's bound of it, else the arm's own."""
    return LARGEST_SUPPLY_V if strategy != "mf" else float(load_arm("grey_box").drive.supply)


def tune_as_paper(model: Model, strategy: str, seed: int) -> tuple[PaperMethod, dict[str, Any]]:
    """The paper's search; what it found, as a board stores it, and its course."""
    task = TuningRequest(
        model, strategy, "paper", BUDGET, seed, 1, printed("before_tuning"), {}, show_no_progress, WITHOUT_FLOORS
    )
    method = PaperMethod(task)
    with TuningJournal(None, {}) as book:
        method.search(book)
    curves = curves_of(method.found)
    return method, {
        "controllers": method.found.best.tolist(),
        "cost_before": list(method.cost_before()),
        "cost": [float(cost) for cost in method.found.cost],
        "narrowed": int(method.found.narrowed),
        "curves": [{"evaluations": list(one.evaluations), "cost": list(one.cost)} for one in curves],
    }


def tune_on_grey_box(seed: int, strategy: str, traces: bool) -> dict[str, Any]:
    """One run of the paper's method, and how its controllers follow: on its model, and on the arm with friction."""
    model = load_model("grey_box", force=True)
    method, found = tune_as_paper(model, strategy, seed)
    controllers = {"before": printed("before_tuning"), "after": method.found.best}
    table, plant = setting(model, supply_of(strategy))
    sticky = load_arm(STICKY)
    real = plant_row(sticky)
    real[column("supply")] = supply_of(strategy)
    return found | {
        "motions": judged(model.arm, table, plant, controllers, traces),
        "sticky": judged(sticky, table, real, controllers),
    }


def print_on_grey_box(seed: int) -> dict[str, Any]:
    """The controllers that the paper prints, each at the supply of its strategy. Nothing is drawn by `seed`."""
    model = load_model("grey_box", force=True)
    found: dict[str, Any] = {}
    for strategy, name in STRATEGIES.items():
        table, plant = setting(model, supply_of(strategy))
        controllers = {"before": printed("before_tuning"), "after": printed(name)}
        found[strategy] = judged(model.arm, table, plant, controllers, traces=True)
    return found


def floors(seed: int) -> dict[str, Any]:
    """The least error (4,) rad² that any controller could reach on the paper's grey-box arm, whatever the seed."""
    arm = load_arm("grey_box")
    found: dict[str, Any] = {}
    for strategy in ("mf", "sf"):
        plant = plant_row(arm).copy()
        plant[column("supply")] = supply_of(strategy)
        for name, make in MOTIONS.items():
            floor = saturation_floor(make(), plant, threads=1)
            found[f"{strategy} {name}"] = {"mse": floor.mse.tolist(), "bound": floor.bound.tolist()}
    return found
