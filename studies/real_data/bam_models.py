"""BAM's friction models M1 to M6, by the equations of arXiv 2410.08650, and a search for their numbers.

Written from the paper and BAM's documentation; the steps are BAM's: its period, and friction as the torque that would
stop the joint within a step, if the friction allows so much.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import Any

import numpy as np

from greywhale.base.types import Floats
from studies.real_data.bam_rig import Swing
from studies.real_data.rigs import GRAVITY

STEP_S = 5e-3  # BAM's own
SEED = 0
WRONG_RAD = 9.0  # of a simulation that left the numbers

# Where each number is searched; BAM's own bounds, but for friction_viscous, which nothing here brings near its end.
MOTOR = {"kt": (0.1, 3.0), "R": (2.0, 5.0), "armature": (1e-4, 0.05), "q_offset": (-0.1, 0.1)}
COULOMB = {"friction_base": (0.0, 0.2), "friction_viscous": (0.0, 0.2)}
STRIBECK = {"friction_stribeck": (0.0, 0.2), "dtheta_stribeck": (0.1, 3.0), "alpha": (1.0, 10.0)}
LOAD = {"load_friction_base": (0.0, 0.5)}
DIRECTIONAL = {
    **{f"load_friction_{side}": (0.0, 0.5) for side in ("motor", "external")},
    **{f"load_friction_{side}_stribeck": (0.0, 1.0) for side in ("motor", "external")},
    **{f"load_friction_{side}_quad": (0.0, 0.01) for side in ("motor", "external")},
}
BOUNDS: dict[str, dict[str, tuple[float, float]]] = {
    "M1": MOTOR | COULOMB,
    "M3": MOTOR | COULOMB | LOAD,
    "M6": MOTOR | COULOMB | STRIBECK | DIRECTIONAL,
}
GENERATIONS = {"M1": 60, "M3": 80, "M6": 300}
POPULATION = 6  # times the numbers


def errors(numbers: Mapping[str, Any], swings: Sequence[Swing]) -> Floats:
    """Mean absolute errors in rad of one model, (recordings,), or of many, (recordings, models): numbers (models,)."""
    rows = int(min(one.time[-1] for one in swings) / STEP_S)
    times: Floats = STEP_S * np.arange(rows, dtype=np.float64)
    goals, measured = np.array([one.at(times) for one in swings]).transpose(1, 2, 0)
    shape = (len(swings), *np.shape(numbers["kt"]))
    of = {name: np.asarray(value) for name, value in numbers.items() if name not in ("model", "actuator")}

    def each(name: str) -> Floats:
        """A recording's number beside those of all models."""
        return np.array([getattr(one, name) for one in swings]).reshape(-1, *(1,) * (len(shape) - 1))

    gain, supply, weight = each("gain"), each("supply"), each("mass") * GRAVITY * each("length")
    inertia = each("mass") * each("length") ** 2 + of["armature"]
    rest = (slice(None), *(None,) * (len(shape) - 1))
    angle = np.broadcast_to(measured[0][rest], shape).copy()
    speed, total = np.zeros(shape), np.zeros(shape)
    with np.errstate(all="ignore"):
        for goal, true in zip(goals, measured, strict=True):
            total += np.abs(angle - true[rest])
            volts = supply * np.clip(gain * (goal[rest] - angle), -1.0, 1.0)
            motor = of["kt"] * (volts - of["kt"] * speed) / of["R"]
            outside = -weight * np.sin(angle + of["q_offset"])
            torque = motor + outside
            stopping = inertia / STEP_S * speed + torque
            most = friction(of, motor, outside, speed) + of["friction_viscous"] * np.abs(speed)
            acceleration = (torque - np.clip(stopping, -most, most)) / inertia
            speed = speed + acceleration * STEP_S
            angle = angle + speed * STEP_S + acceleration * STEP_S**2 / 2
    return np.nan_to_num(total / rows, nan=WRONG_RAD, posinf=WRONG_RAD)


def friction(of: Mapping[str, Floats], motor: Floats, outside: Floats, speed: Floats) -> Floats:
    """The most that friction can hold, N m, without what grows with speed; terms that a model lacks are absent."""

    def term(name: str) -> Any:
        return of.get(f"friction_{name}", 0.0)

    def load(name: str) -> Any:
        return of.get(f"load_friction_{name}", 0.0)

    slow = np.exp(-(np.abs(speed / of["dtheta_stribeck"]) ** of["alpha"])) if "alpha" in of else 0.0
    passed = np.abs(motor - outside)
    held = term("base") + slow * term("stribeck") + passed * (load("base") + slow * load("stribeck"))
    held = held + np.abs(load("motor") * motor - load("external") * outside)
    held = held + slow * np.abs(load("motor_stribeck") * motor - load("external_stribeck") * outside)
    if "load_friction_motor_quad" in of:
        driven = np.abs(motor) > np.abs(outside)
        square = np.where(driven, load("external_quad") * outside**2, load("motor_quad") * motor**2)
        held = held + slow * square * (np.sign(motor) != np.sign(outside))
    return np.asarray(held)


def fit(model: str, swings: Sequence[Swing]) -> dict[str, float]:
    """The numbers with the least mean error on some recordings, by differential evolution."""
    from scipy.optimize import differential_evolution

    names = list(BOUNDS[model])

    def cost(points: Floats) -> Floats:
        numbers = dict(zip(names, points.reshape(len(names), -1), strict=True))
        return np.asarray(errors(numbers, swings).mean(axis=0))

    found = differential_evolution(
        cost,
        list(BOUNDS[model].values()),
        maxiter=GENERATIONS[model],
        popsize=POPULATION,
        vectorized=True,
        updating="deferred",
        polish=False,
        rng=SEED,
    )
    return dict(zip(names, found.x.tolist(), strict=True))
