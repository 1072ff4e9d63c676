"""A motion on simulated arms with the board's controllers in the loop: how the follower moves, and how far it lags."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
import numpy.typing as npt

from greywhale import _native
from greywhale.excite.multisine import board_reference
from greywhale.identify.closed_loop import controller_rows, loop_settings
from greywhale.loop import Timing

Floats = npt.NDArray[np.float64]
RAD = 1.0 / 4096.0
EVERY = 16  # ticks from row to row of the traces
ROW_S = EVERY / 1000
STEPS_PER_TICK = 1
NOISE_V = 0.002
# The arm stands at the first pose for so long before the motion (ticks).
STILL_TICKS = 304


@dataclass(frozen=True)
class Tried:
    """`angles` (plants, rows, 4) rad, 16 ms apart, `lag` (plants,) rad: the most that a joint is behind for 50 ms."""

    angles: Floats
    reference: Floats  # (rows, 4) rad
    lag: Floats
    outside: Floats  # (plants, 4) rad: how far the angles leave what the reference spans


def try_motion(angles: Floats, parameters: Sequence[int], plants: Floats, threads: int = 0) -> Tried:
    """Play points (rows, 4) to arms (n, 60) with the board's parameter table (raw)."""
    reference = np.vstack([np.tile(angles[:1], (STILL_TICKS, 1)), board_reference(angles)])
    loop = _native.ClosedLoop(
        settings=loop_settings(parameters),
        timing=Timing().native(),
        pots=[_pot()] * 4,
        pot_supply=5.0,
        seed=1,
        home=[float(angle) for angle in angles[0]],
        gap=[0.0] * 4,
        reference=np.ascontiguousarray(np.round(reference / RAD).astype(np.int16)),
        leader=np.ascontiguousarray(reference),
        weight=np.zeros(len(reference)),
    )
    outcome = loop.run(
        controllers=controller_rows(parameters)[None],
        plants=np.ascontiguousarray(plants),
        substeps=STEPS_PER_TICK,
        threads=threads,
        every=EVERY,
        single=False,
        instructions="",
    )
    shown = np.nan_to_num(outcome[4].astype(np.float64)[:, STILL_TICKS // EVERY :], nan=1e3, posinf=1e3, neginf=-1e3)
    wanted = reference[STILL_TICKS::EVERY][: shown.shape[1]]
    shown = shown[:, : len(wanted)]
    behind = np.abs(shown - wanted[None]).max(axis=2)
    held = np.lib.stride_tricks.sliding_window_view(behind, round(0.05 / ROW_S), axis=1).min(axis=2)
    outside = np.maximum(shown.max(axis=1) - wanted.max(axis=0), wanted.min(axis=0) - shown.min(axis=1))
    return Tried(shown, wanted, held.max(axis=1), np.maximum(outside, 0.0))


def _pot() -> _native.Potentiometer:
    return _native.Potentiometer(track=math.radians(300.0), centre=0.0, direction=1.0, noise=NOISE_V, linearity=0.0)
