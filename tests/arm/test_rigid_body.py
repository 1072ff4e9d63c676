"""The closed-form links: against outside golden values, and as physics."""

from __future__ import annotations

import json
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray
from scipy.integrate import solve_ivp

from greywhale.arm import Arm
from greywhale.files.arm import default_arm

Vector = NDArray[np.float64]
GOLDEN = json.loads(Path(__file__).with_name("golden_dynamics.json").read_text(encoding="utf-8"))


def test_agrees_with_pinocchio(make_arm: Any) -> None:
    body = Arm(make_arm(GOLDEN["arm"], tip={"mass": GOLDEN["tip_mass"]})).body
    for state in GOLDEN["states"]:
        np.testing.assert_allclose(body.mass_matrix(state["q"]), state["mass_matrix"], rtol=0, atol=1e-12)
        np.testing.assert_allclose(body.bias(state["q"], state["v"]), state["bias"], rtol=0, atol=1e-12)


def test_energy_is_conserved_over_5_s() -> None:
    body = Arm(default_arm()).body

    def motion(_: float, y: Vector) -> Vector:
        q, v = y[:4], y[4:]
        return np.concatenate([v, np.linalg.solve(body.mass_matrix(q), -body.bias(q, v))])

    start = np.array([0.3, 0.4, -0.7, 0.5, 3.0, -1.0, 2.0, 4.0])
    solution = solve_ivp(motion, (0, 5), start, method="DOP853", rtol=1e-12, atol=1e-12)
    energy = [body.kinetic_energy(y[:4], y[4:]) + body.potential_energy(y[:4]) for y in solution.y.T]
    assert np.abs(solution.y[:4]).max() > 3, "the arm must have swung"
    assert np.ptp(energy) < 1e-9
