"""A motion on simulated arms with the board's controllers in the loop: how the follower moves, and how far it lags."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from greywhale.arm.parameters import usual_pots
from greywhale.base.types import Floats
from greywhale.identify.excite.multisine import board_reference
from greywhale.loop.closed_loop import ClosedLoop, known_readings, with_ideal_follower
from greywhale.loop.controllers import controllers_of
from greywhale.protocol.firmware import JOINTS
from greywhale.protocol.table import ParameterTable

EVERY = 16  # ticks between rows of the traces
ROW_S = EVERY / 1000
STEPS_PER_TICK = 1  # of the plant
# The arm stands at the first pose for so many ticks before the motion.
STILL_TICKS = 304


@dataclass(frozen=True)
class Trial:
    """A motion tried: `angles` (plants, rows, 4) rad, 16 ms apart. `lag` (plants,) rad is the largest delay that a
    joint keeps for 50 ms.
    """

    angles: Floats
    lag: Floats


def try_motion(angles: Floats, table: ParameterTable, plants: Floats) -> Trial:
    """Play points (rows, 4) to arms (n, columns) with the board's parameter table."""
    reference = np.vstack([np.tile(angles[:1], (STILL_TICKS, 1)), board_reference(angles)])
    loop = ClosedLoop(
        with_ideal_follower(table),
        known_readings(reference),
        usual_pots(),
        seed=1,
        home=angles[0].tolist(),
        gap=[0.0] * JOINTS,
        weight_s=np.zeros(len(reference)),
    )
    result = loop.run(
        controllers_of(table)[None],
        np.ascontiguousarray(plants),
        substeps=STEPS_PER_TICK,
        every=EVERY,
        threads=1,
    )
    played = result.angles.astype(np.float64)[:, STILL_TICKS // EVERY :]
    shown = np.nan_to_num(played, nan=1e3, posinf=1e3, neginf=-1e3)
    wanted = reference[STILL_TICKS::EVERY][: shown.shape[1]]
    shown = shown[:, : len(wanted)]
    behind = np.abs(shown - wanted[None]).max(axis=2)
    held = np.lib.stride_tricks.sliding_window_view(behind, round(0.05 / ROW_S), axis=1).min(axis=2)
    return Trial(shown, held.max(axis=1))
