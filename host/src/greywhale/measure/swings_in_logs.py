"""Joints that hunt, in a log and in what a model makes of it: how far, how fast, and how they follow apart from that.

Two arms that hunt alike do not swing in step: where each begins a swing is chance. So swings are compared by size and
frequency, and the motion that is left without them is compared as it is.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from greywhale.arm.parameters import JOINT_NAMES
from greywhale.base.types import Floats
from greywhale.measure.limits import HUNTING
from greywhale.measure.swings import smooth_motion
from greywhale.protocol.firmware import JOINTS

# What to do about a model that does not understand a log. Where the log is fitted already, no fit will mend it.
FIT_IT = "fit that log too (greywhale identify takes several)"
PROVE = "it is fitted to that log already, so let greywhale commission prove controllers on the arm itself"


@dataclass(frozen=True)
class Swings:
    """Of every joint (4,): rms of its swings while its leader makes none, rad; their frequency, Hz; if it hunts."""

    rms: tuple[float, ...]
    frequency: tuple[float, ...]
    hunts: tuple[bool, ...]


def swings_of(follower: Floats, leader: Floats, row_s: float) -> Swings:
    """Measure a record (rows, 4) rad with a row every `row_s` seconds: the follower's swings, less its leader's."""
    wanted = _pieces(leader - smooth_motion(leader, row_s), row_s)
    pieces = _pieces(follower - smooth_motion(follower, row_s), row_s) - wanted
    rms = np.sqrt(np.mean(pieces**2, axis=1))
    quiet = np.max(np.abs(wanted), axis=1) < HUNTING.leader_rad
    hunting = quiet & (rms > HUNTING.hunting_rad)
    count = np.maximum(quiet.sum(axis=0), 1)
    found = np.sqrt(np.sum(np.where(quiet, rms, 0.0) ** 2, axis=0) / count)
    hunts = hunting.sum(axis=0) >= np.maximum(2, HUNTING.hunting_share * count)
    return Swings(
        rms=tuple(float(value) for value in found),
        frequency=tuple(_frequency(pieces[hunting[:, joint], :, joint], row_s) for joint in range(JOINTS)),
        hunts=tuple(bool(one) for one in hunts),
    )


def _pieces(swing: Floats, row_s: float) -> Floats:
    """(pieces, rows, 4)."""
    size = min(len(swing), max(2, round(HUNTING.piece_s / row_s)))
    return swing[: len(swing) // size * size].reshape(-1, size, JOINTS)


def _frequency(pieces: Floats, row_s: float) -> float:
    """Mean frequency of pieces (n, rows) by their crossings of zero, Hz; 0 without pieces."""
    if not pieces.size:
        return 0.0
    crossings = np.count_nonzero(np.diff(np.signbit(pieces), axis=1))
    return float(crossings / (2.0 * pieces.shape[0] * (pieces.shape[1] - 1) * row_s))


def describe_difference(
    name: str, log: Swings, model: Swings, joints: tuple[int, ...], fitted: bool = False
) -> list[str]:
    """Sentences for joints whose hunting the model does not predict; `fitted`: though it was fitted to this log."""
    sentences = []
    again = PROVE if fitted else FIT_IT
    reversals = PROVE if fitted else f"record slow reversals with this controller and {FIT_IT}"
    for joint in joints:
        who = f"{name}: joint {joint} ({JOINT_NAMES[joint]})"
        seen, told = 1e3 * log.rms[joint], 1e3 * model.rms[joint]
        if max(seen, told) <= HUNTING.alike * min(seen, told):
            continue  # one may just begin to hunt where the other just does not
        if log.hunts[joint] and not model.hunts[joint]:
            sentences.append(
                f"{who} hunts by {seen:.1f} mrad rms at {log.frequency[joint]:.1f} Hz, but the model rests at "
                f"{told:.1f} mrad; play, backlash or a delay may be missing from the model: {reversals}."
            )
        elif model.hunts[joint] and not log.hunts[joint]:
            sentences.append(
                f"{who} rests at {seen:.1f} mrad rms, but the model hunts by {told:.1f} mrad at "
                f"{model.frequency[joint]:.1f} Hz; the model's gap or play may be too wide, or its friction too small: "
                f"{again}."
            )
        elif log.hunts[joint]:
            sentences.append(
                f"{who} hunts by {seen:.1f} mrad rms, but the model by {told:.1f} mrad; its gap, play or friction may "
                f"be wrong: {again}."
            )
    return sentences
