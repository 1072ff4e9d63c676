"""Records of made-up rigs for tests."""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from studies.one_joint.law import Law
from studies.one_joint.loop import Runner
from studies.one_joint.record import Record, pieces_of


def still(seconds: float, period: float = 1e-3, leader: float = 0.0, volts: float = 0.0, angle: float = 0.0) -> Record:
    """A record in which nothing changes; what a model does along it is up to the model."""
    rows = round(seconds / period)
    hold = np.ones(rows)
    time = np.asarray(period * np.arange(rows), dtype=np.float64)
    return Record("still", time, leader * hold, angle * hold, volts * hold, 0.0 * hold, False, False)


def made(record: Record, law: Law, plant: np.ndarray, noise: float = 0.0, seed: int = 0) -> Record:
    """What a known plant does in the controller, as a record with noisy readings."""
    pieces = pieces_of(record, 0, len(record.time))
    run = Runner(record, law).run(plant, pieces)
    readings = run.angles[0, 0] + noise * np.random.default_rng(seed).standard_normal(len(record.time))
    return replace(record, follower=readings, volts=np.ascontiguousarray(run.volts[0, 0]))
