"""Evidence of earlier trials for a later round: logs with other controllers, and plants that show what the arm did."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from greywhale.arm import ArmParameters
from greywhale.arm.plants import column, plant_row
from greywhale.base.types import Floats
from greywhale.commission.limits import CommissioningLimits, EvidenceLimits
from greywhale.commission.trials import Trial, Trials
from greywhale.files.log import Log, read_evidence
from greywhale.loop.led_model import predict
from greywhale.loop.traces import Traces
from greywhale.measure.swings import turns_of, unrest
from greywhale.protocol.firmware import JOINTS, TICK_S
from greywhale.protocol.table import CONTROLLER_COLUMNS, ParameterTable

KP = CONTROLLER_COLUMNS.index("kp")


@dataclass(frozen=True)
class Evidence:
    """Logs, and the tables that they were recorded with."""

    logs: tuple[Log, ...]
    tables: tuple[ParameterTable, ...]


def to_fit(excite: Evidence, trials: Trials) -> Evidence:
    """The excitation, and the best trials that were played to their end."""
    best = _whole(trials)[: trials.judging.evidence.fitted_trials]
    logs, tables = (read_evidence(one.path) for one in best), (one.table for one in best)
    return Evidence((*excite.logs, *logs), (*excite.tables, *tables))


def to_validate(trials: Trials) -> Evidence:
    """The trial of the controllers from before, and the best that is not fitted."""
    fitted = trials.judging.evidence.fitted_trials
    chosen = (trials.before, *_whole(trials)[fitted : fitted + 1])
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
            plant = _plant_that_hunts(arm, calmest, joint, trials.judging)
            if plant is not None:
                found.append(plant)
    return np.array(found) if found else np.zeros((0, len(plant_row(arm))))


def _plant_that_hunts(arm: ArmParameters, trial: Trial, joint: int, judging: CommissioningLimits) -> Floats | None:
    """The model itself where it hunts; None where no plant in reach does."""
    plants = _variants(plant_row(arm), joint, judging.evidence)
    measured = _unrest(trial.traces, joint)
    for plant, shown in zip(plants, predict(arm, trial.table, trial.traces, plants), strict=True):
        if _shows(shown, trial, joint, measured, judging):
            found: Floats = plant
            return found
    return None


def _variants(plant: Floats, joint: int, limits: EvidenceLimits) -> Floats:
    """The model itself, then with more play, then with wider gaps where its teeth are not rigid: (n, columns)."""
    rows = [plant]
    play, gap, stiffness = (column(name, joint) for name in ("pot_play", "half_gap", "stiffness"))
    for place in (play, gap) if plant[stiffness] > 0.0 else (play,):
        for more in limits.gaps_rad:
            rows.append(plant.copy())
            rows[-1][place] += more
    return np.array(rows)


def _unrest(traces: Traces, joint: int) -> float:
    return float(np.nan_to_num(unrest(traces.leader, traces.follower)[joint]))


def _shows(shown: Traces, trial: Trial, joint: int, measured: float, judging: CommissioningLimits) -> bool:
    if not trial.stopped:
        return _unrest(shown, joint) >= judging.evidence.shown_share * measured
    first = max(0, len(shown.follower) - round(judging.evidence.hunting_end_s / TICK_S))
    cycle = judging.swings.bounds.limit_cycle
    return bool(turns_of(shown.follower, cycle.band_rad, first)[joint] >= cycle.turns)
