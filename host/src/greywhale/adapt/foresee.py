"""Predicts with the model the errors that a set of controllers would have made on what the person did."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from greywhale.adapt.limits import ADAPTATION_LIMITS
from greywhale.adapt.live_model import LiveModel
from greywhale.adapt.stretch import ROWS, Stretch, chains_of, traces_of
from greywhale.base.types import Controllers, Floats
from greywhale.loop.led_model import predict
from greywhale.protocol.table import ParameterTable


def judged_of(stretches: Sequence[Stretch], lead_s: int = ADAPTATION_LIMITS.gain.lead_s) -> list[Stretch]:
    """The stretches for which a prediction can be made: those with `lead_s` others before them."""
    return [one for chain in chains_of(stretches) for one in chain[lead_s:]]


def foresee(
    model: LiveModel, table: ParameterTable, rows: Controllers, stretches: Sequence[Stretch], plants: Floats
) -> Floats:
    """The errors (plants, judged stretches, 4) rad² with controllers (4, 13), on what the leader did."""
    chains = [chain for chain in chains_of(stretches) if len(chain) > model.limits.gain.lead_s]
    if not chains:
        return np.zeros((len(plants), 0, len(rows)))
    return np.concatenate([_foresee_chain(model, table.with_controllers(rows), chain, plants) for chain in chains], 1)


def _foresee_chain(model: LiveModel, table: ParameterTable, chain: Sequence[Stretch], plants: Floats) -> Floats:
    found = predict(model.arm, table, traces_of(chain), plants)
    squares = np.stack([(one.leader - one.follower) ** 2 for one in found])
    errors: Floats = squares.reshape(len(plants), len(chain), ROWS, -1).mean(axis=2)[:, model.limits.gain.lead_s :]
    return errors
