"""Starts for joints that swing on their teeth: a fit from stiff teeth does not find such an optimum."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace

import numpy as np

from greywhale.arm.body import Body
from greywhale.arm.plants import column, columns
from greywhale.identify.candidate import Candidate
from greywhale.identify.data import Prepared
from greywhale.identify.windows import WindowResidual

# At which a joint may swing on its teeth while its motor stands. A fit finds its way from one to half way to the next.
SWINGS_HZ = (6.0, 7.5, 9.0, 11.0, 13.5, 16.5, 20.0, 25.0, 32.0)


def with_soft_teeth(
    windows: WindowResidual, found: Candidate, stiff: Candidate, logs: Sequence[Prepared]
) -> Candidate | None:
    """The model with soft teeth on joints that show them, by how else it would do with a `stiff` gear; None where none
    does.
    """
    tried = [stiff, *(with_swing(stiff, logs, hertz) for hertz in SWINGS_HZ)]
    errors = np.array([np.mean(np.log1p(windows.misfit(one.plant, one.zero)), axis=0) for one in tried])
    x, soft = found.x.copy(), False
    for place, joint in enumerate(windows.joints):
        best = int(np.argmin(errors[:, place]))
        if errors[best, place] < errors[0, place] - windows.limits.search.soft_teeth:
            mine = [index for index, one in enumerate(found.space.parameters) if one.joint == joint]
            x[mine], soft = tried[best].x[mine], True
    return replace(found, x=x) if soft else None


def with_swing(candidate: Candidate, logs: Sequence[Prepared], hertz: float) -> Candidate:
    """The model where every joint swings so often on its teeth."""
    space, plant = candidate.space, candidate.plant
    pose = np.mean([log.smooth[run.slice].mean(axis=0) for log in logs for run in log.runs], axis=0)
    carried = np.diag(Body.of(plant).mass_matrix(pose[None])[0])
    bend = plant[columns("torque_per_volt")] * plant[column("supply")] / (carried * (2.0 * np.pi * hertz) ** 2)
    x = candidate.x.copy()
    for index, one in enumerate(space.parameters):
        if one.kind == "teeth":
            x[index] = np.log(bend[one.joint])
    return replace(candidate, x=np.clip(x, *space.bounds()))
