"""Writes tests/arm/golden_dynamics.json, Pinocchio's values for a few states, so that `make test` needs no Pinocchio.

python tests/oracles/write_arm_golden.py
"""

from __future__ import annotations

import json
from pathlib import Path

import numpy as np
import pinocchio
from arm_engines import MuJoCo, Pinocchio, arm_with_tip, random_states

TARGET = Path(__file__).parents[1] / "arm" / "golden_dynamics.json"


def main() -> None:
    parameters = arm_with_tip()
    one, other = Pinocchio.of(parameters), MuJoCo(parameters)
    states = []
    for q, v in zip(*random_states(40, seed=2), strict=True):
        mass, bias = one.mass_matrix(q), one.bias(q, v)
        if not np.allclose(mass, other.mass_matrix(q), atol=1e-12) or not np.allclose(
            bias, other.bias(q, v), atol=1e-12
        ):
            raise SystemExit(f"Pinocchio and MuJoCo disagree at q = {q}, v = {v}; nothing written.")
        states.append({"q": q.tolist(), "v": v.tolist(), "mass_matrix": mass.tolist(), "bias": bias.tolist()})
    document = {
        "made_by": "python tests/oracles/write_arm_golden.py",
        "engine": f"Pinocchio {pinocchio.__version__}, confirmed by MuJoCo to 1e-12",
        "arm": "default",
        "tip_mass": parameters.tip.mass,
    }
    head = json.dumps(document, indent=1).removesuffix("\n}")
    rows = ",\n".join(f"  {json.dumps(state)}" for state in states)
    TARGET.write_text(f'{head},\n "states": [\n{rows}\n ]\n}}\n', encoding="utf-8")
    print(f"{TARGET}: {len(states)} states, {TARGET.stat().st_size} bytes")


if __name__ == "__main__":
    main()
