"""Logs and the user's arm file come in, and a model comes out: checks, a method's search, judgement."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace

from greywhale.arm import ArmParameters
from greywhale.base.errors import MOST_SEED, BadUsage, require_within
from greywhale.base.types import Progress, show_no_progress
from greywhale.files.log import Log
from greywhale.files.log.check import Check
from greywhale.files.log.reader import refuse_altered
from greywhale.identify import checks, controllers, judge
from greywhale.identify.bounds import doubt_bounds
from greywhale.identify.data import prepare
from greywhale.identify.default import find_default
from greywhale.identify.found_model import FoundModel
from greywhale.identify.gwo_woa import METHOD as GWO_WOA
from greywhale.identify.gwo_woa import find_by_gwo_woa
from greywhale.identify.limits import IDENTIFICATION_LIMITS, IdentificationLimits
from greywhale.identify.overlap import refuse_shared
from greywhale.identify.paper import METHODS as PAPER_METHODS
from greywhale.identify.paper import find_as_paper
from greywhale.identify.request import IdentificationRequest
from greywhale.identify.result import IdentificationResult
from greywhale.protocol.joints import ALL, require_same
from greywhale.protocol.table import ParameterTable

METHODS = ("default", GWO_WOA, *PAPER_METHODS)


def identify(
    logs: Sequence[Log],
    arm: ArmParameters,
    *,
    validate: Sequence[Log] = (),
    tables: Sequence[ParameterTable] = (),
    method: str = "default",
    seed: int = 0,
    begin: ArmParameters | None = None,
    report: Progress | None = None,
    judging: IdentificationLimits = IDENTIFICATION_LIMITS,
) -> IdentificationResult:
    """Find the arm that made the logs. `arm` is the white box to start from and supplies all geometry.

    `begin` is a model of the same arm that the default method found from other logs: its quantities are fitted to these
    logs, and only orders that it lacks are tried. That takes a fraction of the time.
    A log that holds the samples of another one is refused: each is fitted once, and validates only if it was not.
    `tables` are controllers with which the logs may have been recorded; the CRC in each log shows which one it is. An
    interrupt (Ctrl-C) after the first model ends the search early, with `complete` False in the outcome. `judging`
    holds all limits.
    """
    if method not in METHODS:
        raise BadUsage(f"method is {method!r}, but it must be one of {', '.join(METHODS)}.")
    if not logs:
        raise BadUsage("identification needs at least one log.")
    if method in PAPER_METHODS and arm.joints_in_use != ALL:
        raise BadUsage("the paper's methods are for arms with all four joints; use --method default.")
    require_within("seed", seed, 0, MOST_SEED)
    for log in (*logs, *validate):
        refuse_altered(log, Check.CHANGED)
    refuse_shared(logs, validate, judging)
    subjects, doubts = _subjects(logs, validate, arm, tables, judging)
    task = IdentificationRequest(arm, tuple(subjects), seed, report or show_no_progress, begin)
    for subject in subjects:
        checks.refuse_undriven(subject.log, task.moving)
    found, remarks = _find(task, method), (*_remarks(logs, validate), *doubts)
    try:
        return _judged(arm, method, seed, found, subjects, remarks)
    except KeyboardInterrupt:  # it takes a moment, and nobody wants to lose the model
        return _judged(arm, method, seed, replace(found, complete=False), subjects, remarks)


def validated(
    outcome: IdentificationResult, validate: Sequence[Log], tables: Sequence[ParameterTable]
) -> IdentificationResult:
    """Judge the model also on logs that came after it was found; `tables` as for `identify`, for these logs."""
    logs, judging = [subject.log.log for subject in outcome.subjects], outcome.subjects[0].log.limits
    refuse_shared(logs, validate, judging)
    known = [subject.table for subject in outcome.subjects if subject.table is not None]
    subjects, doubts = _subjects(logs, validate, outcome.white_box, (*known, *tables), judging)
    for subject in subjects:
        checks.refuse_undriven(subject.log, outcome.found.joints)
    remarks = (*_remarks(logs, validate), *doubts)
    return _judged(outcome.white_box, outcome.method, outcome.seed, outcome.found, subjects, remarks)


def _judged(
    arm: ArmParameters,
    method: str,
    seed: int,
    found: FoundModel,
    subjects: Sequence[judge.JudgedLog],
    remarks: Sequence[str],
) -> IdentificationResult:
    verdicts = tuple(
        judge.judge(subject, arm, found.plant, found.zero, found.joints, found.draws) for subject in subjects
    )
    at_bounds = () if found.covariance is None else doubt_bounds(found.estimates)  # other methods have other bounds
    return IdentificationResult(
        white_box=arm,
        method=method,
        seed=seed,
        found=found,
        verdicts=verdicts,
        warnings=(*remarks, *judge.warnings_of(verdicts), *judge.undecided_of(verdicts)),
        doubts=(*at_bounds, *judge.doubts_of(verdicts, found.joints)),
        subjects=tuple(subjects),
    )


def _find(task: IdentificationRequest, method: str) -> FoundModel:
    if method in PAPER_METHODS:
        return find_as_paper(task, method)
    return find_by_gwo_woa(task) if method == GWO_WOA else find_default(task)


def _remarks(*logs: Sequence[Log]) -> list[str]:
    """Return the remarks that the model should carry about the condition of its logs."""
    return [remark for some in logs for log in some for remark in log.remarks]


def _subjects(
    logs: Sequence[Log],
    validate: Sequence[Log],
    arm: ArmParameters,
    tables: Sequence[ParameterTable],
    judging: IdentificationLimits,
) -> tuple[list[judge.JudgedLog], list[str]]:
    """Make every log ready, and check it."""
    subjects, doubts = [], []
    crcs = {log.origin.param_crc for log in logs}
    for log in (*logs, *validate):
        require_same("the arm file", arm.joints_in_use, log.name, log.joints_in_use)
        table = controllers.table_of(log, tables)
        if table is not None:
            require_same(log.name, log.joints_in_use, table.name, table.joints_in_use)
        shift = None  # nobody knows how old the readings of another tool are
        if log.origin.firmware is not None:
            shift = (table or ParameterTable.defaults())["filter_shift"]
        prepared = prepare(log, shift, judging)
        doubts += checks.check(prepared, arm, table)
        if any(log is one for one in logs):
            role = judge.FIT
        else:
            role = judge.SECOND if log.origin.param_crc in crcs else judge.CHANGED
        subjects.append(judge.JudgedLog(prepared, table, role))
        if table is None:
            doubts.append(
                f"{log.name}: its controller is not known, so the closed loop cannot be simulated; give it with "
                "--controller (greywhale params backup writes it)."
            )
    return subjects, doubts
