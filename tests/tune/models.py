"""Model files as greywhale identify writes them, of arms that are known, in no time."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np

from greywhale.arm import ArmParameters
from greywhale.base.types import Controllers
from greywhale.files.arm import default_arm
from greywhale.files.model import sealed, to_toml
from greywhale.files.trajectory import Trajectory
from greywhale.identify.space import KINDS, Space
from greywhale.loop import default_controller
from greywhale.measure import Evaluation
from greywhale.measure.evaluate import JointMeasures
from greywhale.protocol.firmware import JOINTS
from greywhale.tune import TuningResult
from greywhale.tune.judge.floor import Floor
from greywhale.tune.judge.held_out import HeldOut
from greywhale.tune.judge.margins import Margin
from greywhale.tune.model import Model, load_model
from greywhale.tune.result import Curve

SEARCHED = ("alpha", "inertia", "damping", "coulomb")


def log_facts(role: str = "fit", improvement: float = 0.99, **more: Any) -> dict[str, Any]:
    """One log that the model was fitted to or judged on."""
    white = [4e-3, 3e-3, 2e-3, 1e-3]
    return {
        "name": f"{role.partition(' ')[0].strip(',')}.csv",
        "role": role,
        "parameter_crc": "0xabcd",
        "period_ms": 1,
        "measure": "closed loop",
        "white_box_mse_rad2": white,
        "model_mse_rad2": [(1.0 - improvement) * value for value in white],
        "improvement": improvement,
        "chance_rad2": 1e-3,
    } | more


def facts_of(
    arm: ArmParameters,
    deviation: float = 0.03,
    joints: tuple[int, ...] = tuple(range(JOINTS)),
    searched: tuple[str, ...] = SEARCHED,
    **changes: Any,
) -> dict[str, Any]:
    """A good [identification] of `arm` whose searched numbers have this relative standard deviation."""
    space = Space.of(arm, searched, joints)
    values = space.values(space.start())
    facts: dict[str, Any] = {
        "status": "complete",
        "method": "default",
        "covariance": (deviation**2 * np.eye(len(space))).tolist(),
        "parameters": {},
        "warnings": [],
        "log": [log_facts(), log_facts("validation", 0.98), log_facts("validation, changed controller", 0.9)],
        "parameter": [
            {
                "name": one.name,
                "unit": KINDS[one.kind].unit,
                "value": float(value),
                "standard_deviation": float(deviation * value),
            }
            for one, value in zip(space.parameters, values, strict=True)
        ],
    }
    facts |= changes
    return {key: value for key, value in facts.items() if value is not None}


def write_model(
    path: Path, arm: ArmParameters | None = None, facts: Mapping[str, Any] | None = None, **changes: Any
) -> Path:
    """A model.toml of `arm` (the default one); `changes` are those of `facts_of`."""
    arm = arm or default_arm()
    facts = facts_of(arm, **changes) if facts is None else facts
    path.write_text(to_toml(arm, sealed(arm, facts)), encoding="utf-8")
    return path


def tuned(model: Model, before: Controllers, after: Controllers, **changes: Any) -> TuningResult:
    """A tuning that nobody ran and nobody judged."""
    plain = TuningResult(
        model=model,
        table=model.table,
        strategy="both",
        method="default",
        seed=3,
        budget=10,
        evaluations=10,
        complete=True,
        before=before,
        after=after,
        cost_before=(1.0,) * JOINTS,
        cost_after=(0.123456,) * JOINTS,
        curves=(),
        margins_before=(),
        margins=(),
        held_out=(),
        worse=(),
        notes=(),
    )
    return replace(plain, **changes)


def judged(path: Path) -> TuningResult:
    """A tuning that nobody ran, on two held-out motions, one of which saturates nothing."""
    model = load_model(path, force=True, samples=2)
    after = default_controller()
    after[2, 8] += 1
    motion, rows = Trajectory(np.array([0.0, 1.0]), np.zeros((2, 4))), np.zeros((1, 4))
    floors = [
        Floor(np.full(4, mse), np.full(4, bound), rows[:, 0], rows, rows)
        for mse, bound in ((0.002, 0.002), (1e-7, 6e-8))
    ]
    held = [
        HeldOut(name, motion, evaluation(0.01), evaluation(0.002468), floor, rows[:, 0], rows, rows, rows)
        for name, floor in zip(("steps", "reaches"), floors, strict=True)
    ]
    margins = [Margin("at rest", joint, 0, 0.0, 0, 2) for joint in (1, 0, 2, 3)]
    return tuned(
        model,
        default_controller(),
        after,
        curves=(Curve((10,), (0.1,)),) * 4,
        margins_before=tuple(margins),
        margins=tuple(margins),
        held_out=tuple(held),
        notes=("a note",),
    )


def evaluation(mse: float) -> Evaluation:
    """Joint 3 never rests and never steps."""
    joints = [JointMeasures(mse, 0.0123456, 0.05, 0.02, 3)] * 3 + [JointMeasures(mse, None, 0.05, None, 0)]
    return Evaluation(tuple(joints), 4 * mse, 1000, 1.0, True, (1.0,) * 3 + (0.0,))
