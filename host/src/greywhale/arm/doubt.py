"""The doubt about an arm's numbers, as a comment in a file of another program: from plants that the logs allow."""

from __future__ import annotations

import numpy as np

from greywhale.arm.parameters import ArmParameters
from greywhale.arm.plants import Plants, column, plant_row

# A column of a plant, and what it is called beside a joint.
_TOLD = {
    "torque_per_volt": "torque per volt {} N m/V",
    "inertia": "armature {} kg m2",
    "damping": "damping with back-EMF {} N m s",
    "coulomb": "friction {} N m",
    "half_gap": "half of the gear's gap {} rad",
    "stiffness": "teeth {} N m/rad",
}


def doubt_of(parameters: ArmParameters, joint: int, drawn: Plants) -> str:
    """Each number of a joint with its 95 % interval over `drawn` plants (n, columns); numbers without a doubt are left
    out, and without plants it is empty.
    """
    if not len(drawn):
        return ""
    estimate = plant_row(parameters)
    found = []
    for name, words in _TOLD.items():
        place = column(name, joint)
        low, high = np.quantile(drawn[:, place], (0.025, 0.975))
        if high > low:
            found.append(words.format(f"{estimate[place]:.4g} [{low:.4g}, {high:.4g}]"))
    return f"95 % of the arms that the logs allow: {', '.join(found)}." if found else ""
