"""How well each kind of model predicts what it was not fitted to, as a share of the joint's range.

In the loop: led by the record's leader alone, from its first row, in the controller that made it. Over windows: under
the logged voltages, each window started from the rows before it.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np

from greywhale.base.types import Floats
from studies.one_joint.fit import Example, JointModel, fit_joint, identify_joint
from studies.one_joint.loop import Runner
from studies.one_joint.naive import fit_lag
from studies.one_joint.record import Record, pieces_of
from studies.real_data.rigs import Source

# A motor without dry friction or gravity: to the speed it is a first-order lag with dead time.
LINEAR = ("inertia", "damping", "delay", "pull")


@dataclass(frozen=True)
class Score:
    """Normalised errors (RMSE as a share of the joint's range over the whole record) on one record."""

    record: str
    range_rad: float
    first_order: float  # lags from leader to follower
    second_order: float
    linear_loop: float  # motor without dry friction, in the known controller
    physics_loop: float
    linear_windows: float
    physics_windows: float

    @property
    def best_naive(self) -> float:
        return min(self.first_order, self.second_order)


@dataclass(frozen=True)
class Comparison:
    """Models fitted to some records, or to their first halves, judged on others, or on the second halves."""

    title: str
    model: JointModel
    scores: tuple[Score, ...]


def first_half(source: Source) -> Source:
    return replace(source, record=source.record.until(source.record.middle))


def compare(title: str, fitted: Sequence[Source], judged: Sequence[Source], begins: Sequence[int]) -> Comparison:
    """Fit every kind of model to `fitted`; judge it on the rows of `judged` from `begins` on."""
    rig = next((one.rig for one in fitted if one.rig.loaded), fitted[0].rig)
    bare = replace(rig, weight=0.0, link_inertia=0.0, alpha=1.0, loaded=False)
    lags = [fit_lag([one.record for one in fitted], order) for order in (1, 2)]
    linear = fit_joint(bare, [Example(one.record, one.law, windows=False) for one in fitted], LINEAR)
    windowed = fit_joint(bare, [Example(one.record, None) for one in fitted], LINEAR)
    physics = identify_joint(rig, [Example(one.record, one.law) for one in fitted])
    scores = []
    for source, begin in zip(judged, begins, strict=True):
        record = source.record
        follows = [lag.follow(record) - record.follower for lag in lags]
        scores.append(
            Score(
                record=record.name,
                range_rad=float(np.ptp(record.follower)),
                first_order=_share(record, follows[0][begin:]),
                second_order=_share(record, follows[1][begin:]),
                linear_loop=loop_error(source, linear.plant, begin),
                physics_loop=loop_error(source, physics.plant, begin),
                linear_windows=window_error(source, windowed.plant, begin),
                physics_windows=window_error(source, physics.plant, begin),
            )
        )
    return Comparison(title, physics, tuple(scores))


def halves(source: Source) -> Comparison:
    """Fitted to the first half of a record, judged on the second."""
    return compare(source.record.name, [first_half(source)], [source], [source.record.middle])


def across(fitted: Sequence[Source], judged: Sequence[Source]) -> Comparison:
    """Fitted to whole records, judged on whole other ones."""
    title = " + ".join(one.record.name for one in fitted)
    return compare(title, fitted, judged, [0] * len(judged))


def loop_error(source: Source, plant: Floats, begin: int) -> float:
    record = source.record
    errors = Runner(record, source.law).errors(plant, pieces_of(record, 0, len(record.time)))
    return _share(record, errors[0, 0, begin:])


def window_error(source: Source, plant: Floats, begin: int) -> float:
    record = source.record
    pieces = pieces_of(record, begin, len(record.time), source.rig.window_s)
    return _share(record, Runner(record, None).errors(plant, pieces)[0])


def _share(record: Record, errors: Floats) -> float:
    return float(np.sqrt(np.mean(errors**2)) / np.ptp(record.follower))
