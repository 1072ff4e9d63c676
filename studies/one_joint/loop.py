"""Runs candidate joints along a record: inside its known controller, or under its logged voltages."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
import one_joint_native

from greywhale.base.types import Floats
from studies.one_joint.law import Law, proportional
from studies.one_joint.record import Pieces, Record

# Longest step of the integration, s.
STEP_S = 1e-3


@dataclass(frozen=True)
class Run:
    """Angles (rad) and motor voltages (V), both (candidates, pieces, rows kept)."""

    angles: Floats
    volts: Floats


class Runner:
    """One record, with the controller that made it or None, ready for any number of candidates."""

    def __init__(self, record: Record, law: Law | None) -> None:
        self.record = record
        self.law = law or proportional(0.0, 0.0)
        self.closed = law is not None
        steps = self.law.steps_per_row
        usual = float(np.median(record.spacing))
        self.substeps = steps * max(1, int(np.ceil(usual / steps / STEP_S - 1e-9)))
        self._states = self.law.states(record.leader, record.follower)

    def run(self, plants: Floats, pieces: Pieces, every: int = 1, threads: int = 0) -> Run:
        """Candidates (rows, 19) along some pieces, each started where the record says the joint was."""
        record, law = self.record, self.law
        angles, volts = one_joint_native.simulate(
            plants=np.ascontiguousarray(plants),
            spacing=record.spacing,
            leader=np.ascontiguousarray(record.leader),
            load=np.ascontiguousarray(record.load),
            volts=np.ascontiguousarray(record.volts),
            substeps=self.substeps,
            leader_lines=record.leader_lines,
            volts_lines=record.volts_lines,
            a=np.ascontiguousarray(law.a),
            b=np.ascontiguousarray(law.b),
            c=np.ascontiguousarray(law.c),
            d=np.ascontiguousarray(law.d),
            limit=law.limit,
            hysteresis=law.hysteresis,
            resolution=record.resolution,
            control_every=self.substeps // law.steps_per_row,
            closed=self.closed,
            first=pieces.first,
            angles=pieces.angles,
            velocities=pieces.velocities,
            states=np.ascontiguousarray(self._states[pieces.first]),
            rows=pieces.rows,
            every=every,
            threads=threads,
        )
        return Run(angles, volts)

    def errors(self, plants: Floats, pieces: Pieces, every: int = 1) -> Floats:
        """Candidates minus record, (candidates, pieces, rows kept), rad; bounded, so that a wild one stays a number."""
        kept = np.arange(0, pieces.rows, every)
        measured = self.record.follower[pieces.first[:, None] + kept[None, :]]
        difference = self.run(plants, pieces, every).angles - measured[None]
        bounded: Floats = np.clip(np.nan_to_num(difference, nan=1e2, posinf=1e2, neginf=-1e2), -1e2, 1e2)
        return bounded
