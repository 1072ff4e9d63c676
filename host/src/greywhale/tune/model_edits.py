"""Finds edits of a model after its identification, and says what to do about them."""

from __future__ import annotations

import numpy as np

from greywhale.arm import ArmParameters
from greywhale.files.model import seals
from greywhale.identify import sampled_plants
from greywhale.loop import PLANT_COLUMNS
from greywhale.tune.limits import TUNING_LIMITS, ModelLimits
from greywhale.tune.model_checks import Doubt, Identification, with_one_uncertain

# Quantities that the search may leave at next to nothing.
OFTEN_NOTHING = (
    *("half_gap", "pot_play", "pot_lag", "load_friction", "creep_velocity"),
    *("lost_up", "lost_down", "supply_resistance"),
)
REMEDY = "identify again, also after a change of the arm or its load"
UNSEALED = (
    "An older greywhale made this model: whether its links and potentiometers were edited since cannot be seen; "
    "identify again to be sure."
)


def doubt_edits(arm: ArmParameters, facts: Identification, limits: ModelLimits = TUNING_LIMITS.model) -> list[Doubt]:
    """Doubt an arm whose numbers are no longer those that were identified."""
    doubt = _doubt_plant(arm, facts, limits) or _doubt_seals(arm, facts)
    return [doubt] if doubt else []


def _doubt_seals(arm: ArmParameters, facts: Identification) -> Doubt | None:
    """Any number of the file: links and potentiometers have no second place that would tell."""
    if facts.seal is None:
        return None
    now = seals(arm, arm.identification or {})
    tables = [key for key in {**now, **facts.seal} if now.get(key) != facts.seal.get(key)]
    if not tables:
        return None
    return Doubt(f"{' and '.join(tables)} in it was edited since the identification, or is of another model", REMEDY)


def _doubt_plant(arm: ArmParameters, facts: Identification, limits: ModelLimits) -> Doubt | None:
    """Numbers of joints that the file holds twice, so that the sentence can name one."""
    if facts.covariance is None or not facts.parameter:
        return None
    now, then = sampled_plants(with_one_uncertain(arm, facts, None), 2)
    # A gap or play of next to nothing is none, whatever its digits.
    least = np.array([limits.same_gap_rad if name.endswith(OFTEN_NOTHING) else 1e-12 for name in PLANT_COLUMNS])
    differs = np.abs(now - then) > limits.same_value * np.maximum(np.abs(now), np.abs(then)) + least
    if not differs.any():
        return None
    place = int(np.argmax(differs))
    return Doubt(
        f"its numbers are not those that were identified ({PLANT_COLUMNS[place]} is {now[place]:.4g}, was "
        f"{then[place]:.4g}), as if it was edited or put together from two arms",
        REMEDY,
    )
