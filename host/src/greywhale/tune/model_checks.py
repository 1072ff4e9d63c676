"""The doubts about tuning for a model: each says what was found and what would mend it."""

from __future__ import annotations

import math
from collections.abc import Iterator, Mapping
from typing import Any, NamedTuple

import numpy as np
from pydantic import BaseModel, ConfigDict, ValidationError

from greywhale.arm import ArmParameters
from greywhale.arm.from_plant import known_before
from greywhale.arm.parameters import JOINT_NAMES
from greywhale.base.errors import UserError
from greywhale.base.types import Floats
from greywhale.identify import sampled_plants
from greywhale.identify.judge import CHANGED, FIT, LogVerdict, warnings_of
from greywhale.identify.limits import JudgeLimits
from greywhale.identify.uncertainty import EXCITATION
from greywhale.loop import Experiment, human_reaches, plant_row
from greywhale.loop.controllers import controllers_of
from greywhale.measure.swings_in_logs import FIT_IT
from greywhale.protocol import schema
from greywhale.protocol.firmware import CONVERSIONS, CONVERTER_COUNTS, TICK_S
from greywhale.protocol.schema import Board
from greywhale.protocol.table import ParameterTable, find_board, refuse_unknown
from greywhale.tune.limits import TUNING_LIMITS, ModelLimits, TrainingLimits, TuningLimits
from greywhale.tune.search.training import fit_motion, moves, reach

SLOW, QUICK = "slow reaches", "quick moves"
SPREAD_SAMPLES, ONE_BY_ONE_SAMPLES = 33, 9  # more would only take longer
REACHES_SEED, REACHES_S, WAIT_TICKS = 2002, 6.0, 200  # of the motions that are played
CERTAIN = 1e-20  # a variance of next to nothing
MATCH = "after `greywhale calibrate`, `greywhale arm match` writes the arm file anew"
CONVERTER_SPAN = 4 * CONVERSIONS * (CONVERTER_COUNTS - 1)  # as the board counts a whole track


class Doubt(NamedTuple):
    """A reason and a remedy: one clause each, without a full stop."""

    reason: str
    remedy: str


class _Facts(BaseModel):
    model_config = ConfigDict(extra="ignore", frozen=True)


class LogFacts(_Facts):
    """One [[identification.log]]."""

    name: str
    role: str
    measure: str = ""
    improvement: float
    chance_rad2: float = 0.0
    white_box_mse_rad2: tuple[float, ...]
    model_mse_rad2: tuple[float, ...]
    period_ms: int | None = None
    parameter_crc: str | None = None

    def verdict(self, limits: JudgeLimits) -> LogVerdict:
        """Return the identification's verdict on this log."""
        pairs = self.white_box_mse_rad2, self.model_mse_rad2
        return LogVerdict(self.name, self.role, self.measure, *pairs, chance=self.chance_rad2, limits=limits)


class ParameterFacts(_Facts):
    """One [[identification.parameter]]."""

    name: str
    value: float
    unit: str = ""
    standard_deviation: float | None = None


class Identification(_Facts):
    """The part of a model's [identification] that matters for tuning."""

    status: str
    method: str
    log: tuple[LogFacts, ...] = ()
    parameter: tuple[ParameterFacts, ...] = ()
    warnings: tuple[str, ...] = ()
    doubts: tuple[str, ...] = ()
    covariance: tuple[tuple[float, ...], ...] | None = None
    parameters: dict[str, int] | None = None
    board: str | None = None
    seal: dict[str, str] | None = None  # a digest of each table; None: of before greywhale sealed its models

    @property
    def made_on(self) -> Board:
        """The board that made the logs. A model that names no board is from an older version, and of a Mega."""
        return Board.MEGA2560 if self.board is None else find_board(self.board)

    def table(self) -> ParameterTable | None:
        """The whole parameter table with which the fitted log was recorded, or None where it is not known."""
        defaults = ParameterTable.defaults(self.made_on)
        if self.parameters is not None:
            return defaults.with_raw(self.parameters)
        crcs = {log.parameter_crc for log in self.log if log.role == FIT}
        return defaults if crcs == {f"0x{defaults.crc:04x}"} else None

    def remarks(self, limits: JudgeLimits) -> tuple[str, ...]:
        """The identification's warnings, without those that follow from the logs' numbers, which are judged here."""
        known = warnings_of([log.verdict(limits) for log in self.log])
        return tuple(warning for warning in self.warnings if warning not in known)


def identification_of(arm: ArmParameters, name: str) -> Identification | None:
    """The checked table [identification] of an arm file, None where there is none."""
    if arm.identification is None:
        return None
    try:
        facts = Identification.model_validate(arm.identification)
    except ValidationError as error:
        first = error.errors()[0]
        where = ".".join(["identification", *(str(part) for part in first["loc"])])
        raise UserError(f"{name}: {where}: {first['msg'].lower()}; identify again.") from None
    refuse_unknown(facts.parameters or (), f"{name}: identification.parameters", "identify again")
    try:
        facts.table()
    except UserError as error:
        raise UserError(f"{name}: identification.parameters: {error.message}") from None
    return facts


def doubt_completeness(facts: Identification | None) -> Iterator[Doubt]:
    """Doubt an arm that was not identified at all, or not to the end."""
    if facts is None:
        yield Doubt(
            "nothing in it was identified: it is an arm file, not a model",
            "make a model from logs of your arm with greywhale identify",
        )
    elif facts.status != "complete":
        yield Doubt(f'its identification is "{facts.status}"', "identify again and let it end")


def doubt_validation(facts: Identification, limits: JudgeLimits) -> Iterator[Doubt]:
    """Doubt a model for which no log speaks but the fitted ones."""
    others = [log for log in facts.log if log.role != FIT]
    if not others:
        yield Doubt(
            "it was not validated on a second log",
            "record another one and identify again with --validate SECOND.csv",
        )
    verdicts = [log.verdict(limits) for log in others]
    poor = [verdict for verdict in verdicts if verdict.is_worse]
    if not poor:
        return
    worst = min(poor, key=lambda verdict: verdict.improvement)
    remedy = "check supply, directions and controller files, record livelier motion and identify again"
    if all(verdict.role == CHANGED for verdict in poor) and len(poor) < len(others):
        remedy = f"{FIT_IT} and validate with another one of that controller"
    learnt = ", though on others it is not: it may have learnt its controller, not the arm"
    yield Doubt(
        f"on {worst.name} ({worst.role}) it is worse than the arm file it began with, by more than chance excuses "
        f"({sum(worst.model):.3g} against {sum(worst.white_box):.3g} rad²){learnt if len(poor) < len(others) else ''}",
        remedy,
    )


def doubt_behaviour(facts: Identification) -> Iterator[Doubt]:
    """Doubt a model that does not understand how a joint hunts, or how it follows with a changed controller."""
    if not facts.doubts:
        return
    more = f" (and {len(facts.doubts) - 1} more such findings)" if len(facts.doubts) > 1 else ""
    reason, _, remedy = facts.doubts[0].rstrip(".").rpartition(": ")
    yield Doubt(f"{reason}{more}", f"to mend it, {remedy}")


def doubt_missing_covariance(arm: ArmParameters, facts: Identification) -> Iterator[Doubt]:
    """Doubt a model that does not say, for every joint in use, how uncertain it is."""
    if facts.covariance is None:
        yield Doubt(
            f"it does not say how uncertain it is (method {facts.method} does not)",
            "identify with --method default",
        )
        return
    still = [joint for joint in arm.joints_in_use if not _parameters_of(facts, joint)]
    if not still:
        return
    named = " and ".join(f"joint {joint} ({JOINT_NAMES[joint]})" for joint in still)
    yield Doubt(
        f"no motor moved {named} in its logs, so nothing of {'it' if len(still) == 1 else 'them'} was identified",
        "record with every joint moving by half a radian or more and identify again",
    )


def doubt_precision(
    arm: ArmParameters, table: ParameterTable, judging: TuningLimits = TUNING_LIMITS
) -> Iterator[Doubt]:
    """Doubt a model if the arms that its logs allow follow differently under the board's present controllers.

    Single parameters may be known poorly without harm (torque per volt of a joint that carries nothing). So the effect
    on the motion decides.
    """
    spread = {SLOW: judging.model.slow_spread, QUICK: judging.model.quick_spread}
    experiments = _motions(arm, table, judging.training)
    plants = sampled_plants(arm, SPREAD_SAMPLES)
    shares = {name: _share_of_error(one, table, plants) for name, one in experiments.items()}
    motion = max(shares, key=lambda name: float(np.max(shares[name])) / spread[name])
    joint = int(np.argmax(shares[motion]))
    if shares[motion][joint] <= spread[motion]:
        return
    facts = identification_of(arm, arm.name)
    assert facts is not None
    harm = {
        index: _share_of_error(
            experiments[motion], table, sampled_plants(with_one_uncertain(arm, facts, index), ONE_BY_ONE_SAMPLES)
        )[joint]
        for index, one in enumerate(facts.parameter)
        if one.name.startswith(f"joint{joint}.")
    }
    guilty = facts.parameter[max(harm, key=lambda index: harm[index])]
    kind = guilty.name.partition(".")[2]
    size = f"{guilty.value:.2g} +- {guilty.standard_deviation or 0.0:.2g} {guilty.unit}".rstrip()
    yield Doubt(
        f"joint {joint} ({JOINT_NAMES[joint]}) is too uncertain: arms that its logs allow follow {motion} "
        f"differently by {100 * shares[motion][joint]:.0f} % of the tracking error (at most "
        f"{100 * spread[motion]:.0f} %), most of all because {kind} is {size}",
        f"record again ({EXCITATION.get(kind, 'move that joint through its range')}) and identify again",
    )


def _motions(arm: ArmParameters, table: ParameterTable, limits: TrainingLimits) -> dict[str, Experiment]:
    low, high = reach(arm, table, plant_row(arm)[None], limits)
    slow = fit_motion(human_reaches(REACHES_SEED, REACHES_S), low, high)
    motions = {SLOW: slow, QUICK: moves(low, high, limits)}
    return {
        name: Experiment(motion, arm, table=table, noise=False, soft_start=False, wait_s=WAIT_TICKS * TICK_S)
        for name, motion in motions.items()
    }


def _share_of_error(experiment: Experiment, table: ParameterTable, plants: Floats) -> Floats:
    """Per joint: how differently the median plant follows from the first one, rms, as a share of its error."""
    result = experiment.run(controllers_of(table), plants, every=10, threads=1)
    angles = result.angles[:, WAIT_TICKS // 10 :].astype(np.float64)
    apart = np.sqrt(((angles[1:] - angles[0]) ** 2).mean(axis=1))
    apart[result.diverged[1:]] = np.inf
    shares: Floats = np.median(apart, axis=0) / np.sqrt(np.maximum(result.mse[0], 1e-12))
    return shares


def with_one_uncertain(arm: ArmParameters, facts: Identification, index: int | None) -> ArmParameters:
    """The arm with one uncertain number, or none. The others keep a tiny variance, so that there is a distribution."""
    assert facts.covariance is not None
    assert arm.identification is not None
    variances = np.full(len(facts.covariance), CERTAIN)
    if index is not None:
        variances[index] = max(CERTAIN, facts.covariance[index][index])
    alone = {"covariance": np.diag(variances).tolist()}
    return arm.model_copy(update={"identification": arm.identification | alone})


def _parameters_of(facts: Identification, joint: int) -> list[ParameterFacts]:
    return [one for one in facts.parameter if one.name.startswith(f"joint{joint}.")]


def doubt_other_arm(model: ArmParameters, arm: ArmParameters, name: str) -> Iterator[Doubt]:
    """Doubt a model of another arm file: geometry, gears, stops and supply must be the user's in both."""
    ours, theirs = (dict(_leaves(known_before(one))) for one in (model, arm))
    for key, value in ours.items():
        other = theirs.get(key)
        if isinstance(value, float) and isinstance(other, float):
            equal = math.isclose(value, other, rel_tol=1e-9)
        else:
            equal = bool(value == other)
        if not equal:
            yield Doubt(
                f"it is of another arm than {name}: {key} is {value} here and {other} there",
                "identify with that arm file",
            )
            return


def _leaves(data: object, name: str = "") -> Iterator[tuple[str, Any]]:
    if isinstance(data, Mapping):
        for key, value in data.items():
            yield from _leaves(value, f"{name}.{key}" if name else str(key))
    elif isinstance(data, list | tuple):
        for index, value in enumerate(data):
            yield from _leaves(value, f"{name}[{index}]")
    else:
        yield name, data


def doubt_other_table(given: ParameterTable, logged: ParameterTable | None, name: str) -> Iterator[Doubt]:
    """Doubt a board's table that differs from the logs' in more than its controllers and limits."""
    if logged is None:
        return
    for parameter in schema.PARAMETERS:
        matters = parameter.name in ("supply_mv", "filter_shift") or parameter.name.endswith(
            (".zero", ".scale", ".motor_sign")
        )
        here, there = given[parameter.name], logged[parameter.name]
        if matters and here != there:
            was, now = (f"{parameter.to_physical(raw):g} {parameter.unit}".rstrip() for raw in (there, here))
            yield Doubt(
                f"its logs were recorded with another parameter table than {name}: {parameter.name} was {was} and "
                f"is {now}",
                "record and identify with the board as it is now",
            )
            return


def doubt_other_board(
    arm: ArmParameters,
    facts: Identification | None,
    table: ParameterTable,
    limits: ModelLimits = TUNING_LIMITS.model,
) -> Iterator[Doubt]:
    """Doubt a table whose period, supply or potentiometers are not those of the model and its logs."""
    yield from _doubt_period(facts, table)
    yield from _doubt_supply(arm, table, limits.same_supply)
    yield from _doubt_slopes(arm, table, limits.same_slope)


def _doubt_period(facts: Identification | None, table: ParameterTable) -> Iterator[Doubt]:
    period = table.period_ms
    logged = sorted({log.period_ms for log in facts.log if log.period_ms is not None}) if facts is not None else []
    if logged and period not in logged:
        yield Doubt(
            f"its logs were recorded at a control period of {' and '.join(map(str, logged))} ms, but the tuning is for "
            f"{period} ms",
            f"record and identify at {period} ms",
        )


def _doubt_supply(arm: ArmParameters, table: ParameterTable, same_supply: float) -> Iterator[Doubt]:
    supply = table.supply_v
    if abs(supply - arm.drive.supply) > same_supply * arm.drive.supply:
        yield Doubt(
            f"its drive.supply is {arm.drive.supply:g} V, but the board's supply_mv says {supply:g} V",
            "correct the one that is wrong (greywhale params set supply_mv=..., or the arm file and identify again)",
        )


def _doubt_slopes(arm: ArmParameters, table: ParameterTable, same_slope: float) -> Iterator[Doubt]:
    for side, bank in (("leader", arm.leader_pots), ("follower", arm.follower_pots)):
        for joint, pot in enumerate(bank.joint):
            scale = f"{side}{joint}.scale"
            if table[scale] == 0:  # it is not there
                continue
            track = table.physical(scale) * CONVERTER_SPAN
            wanted = pot.direction * pot.track
            if abs(track - wanted) > same_slope * abs(wanted):
                yield Doubt(
                    f"its {side} potentiometer {joint} turns {wanted:.3g} rad from end to end, but the board's "
                    f"{scale} makes it {track:.3g} rad",
                    f"correct the one that is wrong ({MATCH})",
                )
                return
