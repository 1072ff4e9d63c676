"""From recordings to controllers, as with a real arm: identify, tune on the model, write both files."""

from __future__ import annotations

import time
from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING

import numpy as np

from greywhale.arm import ArmParameters
from greywhale.arm.parameters import Friction, Gear
from greywhale.base.types import NotedProgress, show_no_progress
from greywhale.files.arm import load_arm

if TYPE_CHECKING:
    from greywhale.files.log import Log
    from greywhale.identify import IdentificationResult
    from greywhale.protocol.table import ParameterTable
    from greywhale.tune import TuningResult


@dataclass(frozen=True)
class Learnt:
    """A model and the controllers tuned on it, each with its file and its wall time."""

    model: Path
    controller: Path
    identification: IdentificationResult
    tuning: TuningResult
    identify_s: float
    tune_s: float


def learn(
    fit: Log,
    validate: Sequence[Log],
    tables: Sequence[ParameterTable],
    nominal: ArmParameters,
    folder: Path,
    budget: int | None = None,
    report: NotedProgress = show_no_progress,
) -> Learnt:
    """Write model.toml and controller.toml into `folder`; an interrupt ends it with KeyboardInterrupt.

    It knows nothing of the arm but `nominal` and the logs; `tables` are the parameters with which these were recorded.
    """
    # Slow to import, and useless to those who only want a bench.
    from greywhale.identify import identify
    from greywhale.tune import tune
    from greywhale.tune.limits import WITHOUT_FLOORS
    from greywhale.tune.model import load_model
    from greywhale.tune.report.controller_file import save

    model_file, controller_file = folder / "model.toml", folder / "controller.toml"
    started = time.monotonic()
    identification = identify([fit], nominal, validate=validate, tables=tables, report=report)
    identification.save(model_file)
    if not identification.complete:
        raise KeyboardInterrupt
    identified = time.monotonic()
    # The caller shows the model's doubts: a demo that stopped at one would show nothing.
    model = load_model(model_file, force=True)
    tuning = tune(model, budget=budget, report=report, judging=WITHOUT_FLOORS)
    save(tuning, controller_file)
    if not tuning.complete:
        raise KeyboardInterrupt
    tuned = time.monotonic()
    return Learnt(model_file, controller_file, identification, tuning, identified - started, tuned - identified)


def draw(learnt: Learnt, folder: Path) -> tuple[Path, ...]:
    """Draw the fuzzy sets before and after tuning, and how the costs fell; the paths."""
    # Matplotlib takes a second to import.
    from greywhale.pictures.page import save_into, style
    from greywhale.pictures.tuning import cost_words, plot_convergence, plot_sets

    tuning = learnt.tuning
    joints = tuning.model.arm.joints_in_use
    curves = [(np.array(one.evaluations), np.array(one.cost)) for one in tuning.curves]
    with style():
        sets = plot_sets(tuning.before, tuning.after, joints)
        costs = plot_convergence(curves, "Convergence of the tuning", cost_words(tuning.method), joints)
        return save_into(sets, folder, "sets.png"), save_into(costs, folder, "convergence.png")


def arm_as_drawn(arm: ArmParameters) -> ArmParameters:
    """The arm as its drawings show it: geometry, stops, potentiometers and supply, with the paper's white-box motors.

    The motors' true values, friction and backlash are left out: an identification has to find them.
    """
    white = load_arm("white_box")
    joints = tuple(
        joint.model_copy(update={"motor": known.motor, "friction": Friction(), "gear": Gear()})
        for joint, known in zip(arm.joint, white.joint, strict=True)
    )
    name = f"{arm.name}, as drawn"
    return arm.model_copy(update={"name": name, "motor_equation": white.motor_equation, "joint": joints})
