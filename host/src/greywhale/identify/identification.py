"""Logs and the user's arm file in, a model out: checks, search, judgement."""

from __future__ import annotations

from collections.abc import Callable, Sequence

import numpy as np
from numpy.typing import NDArray

from greywhale.arm import ArmParameters
from greywhale.errors import BAD_USAGE, UserError
from greywhale.files.log import Log
from greywhale.firmware import JOINTS
from greywhale.identify import checks, controllers, judge
from greywhale.identify.closed_loop import Loop
from greywhale.identify.data import FINE_STEP_S, Prepared, prepare
from greywhale.identify.outcome import Outcome, ParameterEstimate
from greywhale.identify.paper import METHODS as PAPER_METHODS
from greywhale.identify.paper import VALUES, PaperSearch
from greywhale.identify.search import Search
from greywhale.identify.space import KINDS, Space
from greywhale.identify.uncertainty import uncertainty
from greywhale.identify.windows import WindowResidual
from greywhale.table import ParameterTable

Floats = NDArray[np.float64]
Report = Callable[[str, float], None]
METHODS = ("default", *PAPER_METHODS)


def identify(
    logs: Sequence[Log],
    arm: ArmParameters,
    *,
    validate: Sequence[Log] = (),
    tables: Sequence[ParameterTable] = (),
    method: str = "default",
    seed: int = 0,
    report: Report | None = None,
) -> Outcome:
    """Find the arm that made the logs. `arm` is the white box to start from and supplies all geometry.

    `tables` are controllers that the logs may have been recorded with; which is which is told by the CRC in each log.
    An interrupt (Ctrl-C) after the first model ends the search early, with `complete` False in the outcome.
    """
    if method not in METHODS:
        raise UserError(f"method is {method!r}, but it must be one of {', '.join(METHODS)}.", BAD_USAGE)
    if not logs:
        raise UserError("identification needs at least one log.", BAD_USAGE)
    tell = report or (lambda what, fraction: None)
    subjects, doubts = _subjects(logs, validate, arm, tables)
    fitted = [subject for subject in subjects if subject.role == judge.FIT]
    joints = [joint for joint in range(JOINTS) if any(subject.log.moving[joint] for subject in fitted)]
    known = all(subject.table is not None for subject in fitted)
    loops = [Loop(subject.log, subject.table, arm) for subject in fitted if subject.table] if known else []
    if method == "default":
        return _default(fitted, subjects, doubts, arm, loops, joints, seed, tell)
    if not loops:
        raise UserError(
            f"{fitted[0].log.log.name}: the paper's method needs the controller that the log was recorded with; "
            "give it with --controller."
        )
    return _paper(method, subjects, doubts, arm, loops, seed, tell)


def _subjects(
    logs: Sequence[Log], validate: Sequence[Log], arm: ArmParameters, tables: Sequence[ParameterTable]
) -> tuple[list[judge.Subject], list[str]]:
    """Every log made ready and checked."""
    subjects, doubts = [], []
    crcs = {log.origin.param_crc for log in logs}
    for log in (*logs, *validate):
        table = controllers.table_of(log, tables)
        shift = None  # of another tool's readings nobody knows how old they are
        if log.origin.firmware is not None:
            shift = (table or ParameterTable.defaults())["filter_shift"]
        prepared = prepare(log, shift)
        doubts += checks.check(prepared, arm, table)
        if any(log is one for one in logs):
            role = judge.FIT
        else:
            role = judge.SECOND if log.origin.param_crc in crcs else judge.CHANGED
        subjects.append(judge.Subject(prepared, table, role))
        if table is None:
            doubts.append(
                f"{log.name}: its controller is not known, so the closed loop cannot be simulated; give it with "
                "--controller (greywhale params backup writes it)."
            )
    return subjects, doubts


def _default(
    fitted: Sequence[judge.Subject],
    subjects: Sequence[judge.Subject],
    doubts: Sequence[str],
    arm: ArmParameters,
    loops: Sequence[Loop],
    joints: Sequence[int],
    seed: int,
    report: Report,
) -> Outcome:
    prepared: list[Prepared] = [subject.log for subject in fitted]
    search = Search(arm, prepared, loops, joints, seed, report)
    try:
        search.run()
    except KeyboardInterrupt:
        if search.best is None:
            raise
    best = search.best
    assert best is not None
    report("judging the model", 0.0)
    space = best.space
    zero, plant = best.zero, best.plant
    windows = WindowResidual(prepared, arm, joints, longest_step=FINE_STEP_S)
    windows.settle(plant, zero)
    sure = uncertainty(windows, space, best.x, joints)
    verdicts = tuple(judge.judge(subject, arm, plant, zero, joints) for subject in subjects)
    return Outcome(
        white_box=arm,
        method="default",
        seed=seed,
        plant=plant,
        zero=zero,
        order=best.order,
        orders=tuple((one.order, float(one.held_out or 0.0)) for one in search.tried),
        estimates=_estimates(space, best.x, sure.deviations),
        covariance=sure.covariance,
        condition=sure.condition,
        open=sure.open,
        verdicts=verdicts,
        warnings=(*doubts, *judge.warnings_of(verdicts)),
        subjects=tuple(subjects),
        simulations=search.simulations,
        simulated=search.simulated,
        complete=search.complete,
        curve=(),
    )


def _estimates(space: Space, x: Floats, deviations: Floats) -> tuple[ParameterEstimate, ...]:
    """Values and standard deviations as people read them: a logarithm's deviation is a share of the value."""
    start, values = space.values(space.start()), space.values(x)
    estimates = []
    for index, parameter in enumerate(space.parameters):
        kind = KINDS[parameter.kind]
        deviation = float(deviations[index]) * (float(values[index]) if kind.logarithmic else 1.0)
        before, after = float(start[index]), float(values[index])
        estimates.append(ParameterEstimate(parameter.name, kind.means, kind.unit, before, after, deviation))
    return tuple(estimates)


def _paper(
    method: str,
    subjects: Sequence[judge.Subject],
    doubts: Sequence[str],
    arm: ArmParameters,
    loops: Sequence[Loop],
    seed: int,
    report: Report,
) -> Outcome:
    search = PaperSearch(arm, loops, seed, report, method)
    try:
        search.run()
    except KeyboardInterrupt:
        if search.x is None:
            raise
    assert search.x is not None
    plant = search.plants(search.x[None])[0]
    zero = np.zeros(JOINTS)
    motors = [joint.motor.model_dump() for joint in arm.joint]
    estimates = tuple(
        ParameterEstimate(
            f"joint{joint}.{name}",
            "motor value of Table 4",
            "",
            motors[joint][name],
            float(search.x[5 * joint + n]),
            None,
        )
        for joint in range(JOINTS)
        for n, name in enumerate(VALUES)
    )
    verdicts = tuple(judge.judge(subject, arm, plant, zero, range(JOINTS)) for subject in subjects)
    return Outcome(
        white_box=arm,
        method=method,
        seed=seed,
        plant=plant,
        zero=zero,
        order="motors",
        orders=(),
        estimates=estimates,
        covariance=None,
        condition=None,
        open=("two of the five motor values of every joint: motion shows three combinations of them only",),
        verdicts=verdicts,
        warnings=(*doubts, *judge.warnings_of(verdicts)),
        subjects=tuple(subjects),
        simulations=search.simulations,
        simulated=search.simulations * sum(loop.seconds for loop in loops),
        complete=search.complete,
        curve=tuple(search.curve),
    )
