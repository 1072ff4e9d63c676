"""The model to tune for: an identified arm, the board's parameter table, and other arms that are as likely.

A model that nobody validated, or that belongs to another arm or board, is refused with the reason, unless forced.
"""

from __future__ import annotations

import hashlib
from dataclasses import dataclass, field
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from greywhale.arm import ArmParameters
from greywhale.base.errors import UserError, require_within
from greywhale.base.types import Floats
from greywhale.files import parameter_file
from greywhale.files.arm import content_of, load_arm
from greywhale.identify import loosen_gears, sampled_plants
from greywhale.loop import plant_row
from greywhale.loop.controllers import controllers_of
from greywhale.protocol.joints import require_same
from greywhale.protocol.schema import Board
from greywhale.protocol.table import ParameterTable
from greywhale.tune import model_checks as checks
from greywhale.tune.limits import TUNING_LIMITS, TuningLimits
from greywhale.tune.model_checks import Doubt, Identification
from greywhale.tune.model_edits import UNSEALED, doubt_edits
from greywhale.tune.travel import Travel, travel_of

SAMPLES = 8  # unless somebody asks for others
MOST_SAMPLES = 1000  # every one is simulated for every controller that is tried


@dataclass(frozen=True)
class Model:
    """An arm to tune for. `doubts` are sentences that speak against it; a validated model has none."""

    name: str
    arm: ArmParameters
    table: ParameterTable  # of the board that it is tuned for
    # (k, columns): the estimate, the same with looser gears, then arms drawn from its covariance; k = 1 without one.
    plants: Floats = field(repr=False)
    doubts: tuple[str, ...]
    file: str
    digest: str  # SHA-256 of the file, hexadecimal
    travel: Travel | None = None  # None: the board's stays, because nothing says how uncertain the arm is

    @property
    def controllers(self) -> NDArray[np.int32]:
        """The controllers that the board runs now: int32 (4, 13)."""
        return controllers_of(self.table)

    @property
    def period_ms(self) -> int:
        """The control period."""
        return self.table.period_ms


def load_model(
    path: str | Path,
    *,
    samples: int = SAMPLES,
    seed: int = 0,
    force: bool = False,
    params: str | Path | None = None,
    arm: str | Path | None = None,
    judging: TuningLimits = TUNING_LIMITS,
) -> Model:
    """Read a model.toml (or an arm.toml, or one of the shipped arms by name, with `force`) and judge it.

    `samples` plants are drawn from its covariance with `seed`; the estimate is one of them. One more has looser gears.
    `params` is a file of `greywhale params backup`: the table to tune for. Without it, that is the table with which the
    model's logs were recorded. `arm` is the arm file to which the model must belong. Raises UserError with the gravest
    doubt; with `force`, the model keeps all doubts instead.
    """
    require_within("samples", samples, 1, MOST_SAMPLES)
    identified = load_arm(path)
    facts = checks.identification_of(identified, str(path))
    table, table_doubts = _table(identified, facts, params)
    require_same(str(path), identified.joints_in_use, table.name, table.joints_in_use)
    doubts = _doubts(identified, facts, table, arm, judging)
    plants = plant_row(identified)[None]
    travel = None
    if facts is not None and facts.covariance is not None:
        plants = np.insert(
            sampled_plants(identified, samples, seed), 1, loosen_gears(identified, judging.model.gear_sigmas), axis=0
        )
        doubts += checks.doubt_precision(identified, table, judging)
        travel = travel_of(identified, table, limits=judging.travel)
    doubts += table_doubts
    if doubts and not force:
        raise UserError(_refusal(str(path), doubts))
    remarks: tuple[str, ...] = ()
    if facts is not None:
        remarks = (*facts.remarks(judging.identification.judge), *([UNSEALED] if facts.seal is None else []))
    return Model(
        name=identified.name,
        arm=identified,
        table=table,
        plants=plants,
        doubts=(*(doubt.reason + "." for doubt in doubts), *remarks),
        file=str(path),
        digest=hashlib.sha256(content_of(path)).hexdigest(),
        travel=travel,
    )


def _doubts(
    arm: ArmParameters,
    facts: Identification | None,
    table: ParameterTable,
    wanted: str | Path | None,
    judging: TuningLimits,
) -> list[Doubt]:
    """Everything that speaks against the model, the gravest first."""
    doubts = list(checks.doubt_completeness(facts))
    if facts is not None:
        doubts += doubt_edits(arm, facts, judging.model)
        doubts += checks.doubt_validation(facts, judging.identification.judge)
        doubts += checks.doubt_behaviour(facts)
        doubts += checks.doubt_missing_covariance(arm, facts)
    if wanted is not None:
        doubts += checks.doubt_other_arm(arm, load_arm(wanted), str(wanted))
    return [*doubts, *checks.doubt_other_board(arm, facts, table, judging.model)]


def _table(
    arm: ArmParameters, facts: Identification | None, params: str | Path | None
) -> tuple[ParameterTable, list[Doubt]]:
    """The parameter table to tune for, and the doubts about it."""
    board = facts.made_on if facts is not None else Board.MEGA2560
    logged = facts.table() if facts is not None else None
    if params is not None:
        given = parameter_file.load(params).for_board(board)
        return given, list(checks.doubt_other_table(given, logged, str(params)))
    if logged is not None:
        return logged, []
    # The best guess: the shipped values, with what the model does state.
    known = {"supply_mv": round(1000.0 * arm.drive.supply)}
    if facts is not None and facts.log and facts.log[0].period_ms is not None:
        known["period_ms"] = facts.log[0].period_ms
    guess = ParameterTable.defaults(board).with_joints(arm.joints_in_use).with_raw(known)
    if facts is None:
        return guess, []
    doubt = Doubt(
        "the parameter table of its logs is not known",
        "give the board's own (greywhale params backup) with --params",
    )
    return guess, [doubt]


def _refusal(path: str, doubts: list[Doubt]) -> str:
    more = len(doubts) - 1
    others = f" ({more} more reason{'s' if more > 1 else ''} would come after this one)" if more else ""
    return f"{path}: {doubts[0].reason}; {doubts[0].remedy}, or go on with --force{others}."
