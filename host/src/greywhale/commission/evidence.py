"""What earlier trials tell a later round: logs with other controllers, and plants that show what the arm did."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from greywhale.arm import ArmParameters
from greywhale.arm.plants import column, plant_row
from greywhale.base.types import Floats
from greywhale.commission.trials import Trial, Trials
from greywhale.files.log import Log, read_evidence
from greywhale.loop.led_model import predict
from greywhale.loop.traces import Traces
from greywhale.measure.swings import LIMIT_CYCLE, turns_of, unrest
from greywhale.protocol.firmware import JOINTS, TICK_S
from greywhale.protocol.table import CONTROLLER_COLUMNS, ParameterTable

KP = CONTROLLER_COLUMNS.index("kp")

# Trials whose logs a later round fits, besides the excitation.
MOST_FITTED = 2
# What may be wrong with a model under which a joint rests and on the arm does not, mildest first: more play at the
# potentiometer or a wider gap (rad, to either side), a slower potentiometer (s), or more loop gain.
GAPS = (0.002, 0.005, 0.01, 0.02)
LAGS = (1e-3, 2e-3, 4e-3)
GAINS = (1.4, 2.0, 2.8)
LAST_S = 0.8  # of a log that ended in hunting
# A plant shows unrest from this share of the measured one on.
SHOWN = 0.5


@dataclass(frozen=True)
class Evidence:
    """Logs, and the tables that they were recorded with."""

    logs: tuple[Log, ...]
    tables: tuple[ParameterTable, ...]


def to_fit(excite: Log, trials: Trials) -> Evidence:
    """The excitation, and the best trials that were played to their end."""
    best = _whole(trials)[:MOST_FITTED]
    return Evidence((excite, *(read_evidence(one.path) for one in best)), (trials.table, *(one.table for one in best)))


def to_validate(trials: Trials) -> Evidence:
    """The trial of the controllers from before, and the best that is not fitted."""
    chosen = (trials.before, *_whole(trials)[MOST_FITTED : MOST_FITTED + 1])
    return Evidence(tuple(read_evidence(one.path) for one in chosen), tuple(one.table for one in chosen))


def _whole(trials: Trials) -> list[Trial]:
    """Trials that nothing stopped, but that of the controllers from before; the best first."""
    return sorted((one for one in trials.done[1:] if not one.stopped), key=lambda one: one.score)


def failing_plants(arm: ArmParameters, trials: Trials) -> Floats:
    """For each joint that a model called calm and the arm did not: the mildest plant that hunts as the arm did."""
    found = []
    for joint in range(JOINTS):
        restless = [one for one in trials.done[1:] if one.verdicts[joint].hunts]
        if restless:
            # The one nearest to rest shows best where the margin is.
            calmest = min(restless, key=lambda one: int(one.rows[joint, KP]))
            plant = _plant_that_hunts(arm, calmest, joint)
            if plant is not None:
                found.append(plant)
    return np.array(found) if found else np.zeros((0, len(plant_row(arm))))


def _plant_that_hunts(arm: ArmParameters, trial: Trial, joint: int) -> Floats | None:
    """The model itself where it hunts; None where no plant in reach does."""
    plants = _variants(plant_row(arm), joint)
    measured = _unrest(trial.traces, joint)
    for plant, shown in zip(plants, predict(arm, trial.table, trial.traces, plants), strict=True):
        if _shows(shown, trial, joint, measured):
            found: Floats = plant
            return found
    return None


def _variants(plant: Floats, joint: int) -> Floats:
    """The model itself, then with more play, wider gaps (where its teeth are not rigid), lag and gain: (n, columns)."""
    rows = [plant]
    gap, stiffness, gain = (column(name, joint) for name in ("half_gap", "stiffness", "torque_per_volt"))
    toothed = ((gap, GAPS),) if plant[stiffness] > 0.0 else ()
    for place, sizes in ((column("pot_play", joint), GAPS), *toothed, (column("pot_lag", joint), LAGS)):
        for more in sizes:
            rows.append(plant.copy())
            rows[-1][place] += more
    for factor in GAINS:
        rows.append(plant.copy())
        rows[-1][gain] *= factor
    return np.array(rows)


def _unrest(traces: Traces, joint: int) -> float:
    return float(np.nan_to_num(unrest(traces.leader, traces.follower)[joint]))


def _shows(shown: Traces, trial: Trial, joint: int, measured: float) -> bool:
    if not trial.stopped:
        return _unrest(shown, joint) >= SHOWN * measured
    first = max(0, len(shown.follower) - round(LAST_S / TICK_S))
    return bool(turns_of(shown.follower, LIMIT_CYCLE.band_rad, first)[joint] >= LIMIT_CYCLE.turns)
