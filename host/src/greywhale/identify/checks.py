"""Finds logs that are useless for identification before any use; each sentence names joint and evidence."""

from __future__ import annotations

from collections.abc import Sequence
from typing import NoReturn

import numpy as np
from numpy.typing import NDArray

from greywhale.arm import ArmParameters
from greywhale.base.errors import UserError
from greywhale.base.types import Floats
from greywhale.files.log.driven import tell_off, tell_undriven
from greywhale.files.log.limits import MOTORS
from greywhale.files.log.units import doubt_spacing
from greywhale.identify.data import Prepared, rows_in
from greywhale.identify.limits import CheckLimits
from greywhale.protocol.firmware import JOINTS
from greywhale.protocol.table import ParameterTable


def check(prepared: Prepared, arm: ArmParameters, table: ParameterTable | None) -> list[str]:
    """Refuse a log that cannot be used; doubts that do not forbid it come back as sentences."""
    log, limits = prepared.log, prepared.limits.checks
    off = tell_off(log)
    if off:
        raise UserError(f"{log.name}: {off}.")
    used = rows_in(prepared.runs, len(log.time))
    if prepared.period > limits.farthest_s:
        raise UserError(
            f"{log.name}: its rows are {prepared.period:.3g} s apart, but at most {limits.farthest_s:g} s show how an "
            "arm moves; is time_s in ms? Record more samples a second, or give times in s."
        )
    seconds = sum(run.period * (run.stop - run.start - 1) for run in prepared.runs)
    if seconds < limits.shortest_s:
        remedy = next(iter(doubt_spacing(log.time)), "record longer.")
        raise UserError(
            f"{log.name}: only {seconds:.1f} s of it can be used (motors following, no gap), but at least "
            f"{limits.shortest_s:g} s are needed; {remedy}"
        )
    leader, follower, voltage = log.leader[used], log.follower[used], log.voltage[used]
    if not prepared.moving.any():
        _refuse_still(log.name, leader, follower)
    doubts = [f"{log.name}: {told}." for told in tell_undriven(log, used).values()]
    if not prepared.shown.any():
        raise UserError(doubts[0])
    for joint in np.flatnonzero(prepared.moving):
        where = f"{log.name}: joint {joint}"
        _refuse_clipped(where, follower[:, joint], limits)
        _refuse_swapped(where, leader[:, joint], follower[:, joint], voltage[:, joint], limits.against)
        doubts += _supply(where, voltage[:, joint], arm, limits.saturated_share)
    _refuse_other_period(prepared, table, used)
    return doubts


def _refuse_still(name: str, leader: Floats, follower: Floats) -> NoReturn:
    ranges = ", ".join(f"{np.ptp(follower[:, joint]):.3f}" for joint in range(JOINTS))
    led = float(np.ptp(leader, axis=0).max())
    remedy = "move the leader while recording"
    if led > MOTORS.motion_rad:
        remedy = f"the leader moved by {led:.2g} rad, so check the motors' supply and the follower's potentiometers"
    raise UserError(
        f"{name}: no joint moved: joints 0..3 stayed within {ranges} rad, but {MOTORS.motion_rad:g} rad at least are "
        f"needed; {remedy}."
    )


def refuse_undriven(prepared: Prepared, joints: Sequence[int]) -> None:
    """Refuse a log in which one of the identified `joints` moved without its motor: it would mislead the fit."""
    log = prepared.log
    for joint, told in tell_undriven(log, rows_in(prepared.runs, len(log.time))).items():
        if joint in joints:
            raise UserError(
                f"{log.name}: {told}; another log shows how voltages move this joint, so leave this one out or record "
                "it again."
            )


def _refuse_clipped(where: str, follower: Floats, limits: CheckLimits) -> None:
    for extreme in (follower.max(), follower.min()):
        share = float(np.mean(follower == extreme))
        if abs(extreme) > limits.clipped_from_rad and share > limits.clipped_share:
            raise UserError(
                f"{where} is clipped: its follower reads exactly {extreme:.4f} rad in {100 * share:.0f} % of the rows, "
                "as a potentiometer at its end does; keep the motion within its range, or correct its zero."
            )


def _refuse_swapped(where: str, leader: Floats, follower: Floats, voltage: Floats, against: float) -> None:
    error = leader - follower
    if np.std(error) < 1e-4 or np.std(voltage) < 1e-3:
        return
    likeness = float(np.corrcoef(error, voltage)[0, 1])
    if likeness < against:
        raise UserError(
            f"{where} looks as if leader and follower columns were swapped (or the motor's direction inverted): its "
            f"voltage pushes away from the leader (correlation of voltage with leader - follower {likeness:.2f})."
        )


def _supply(where: str, voltage: Floats, arm: ArmParameters, saturated_share: float) -> list[str]:
    largest = float(np.abs(voltage).max())
    if largest > 1.02 * arm.drive.supply:
        raise UserError(
            f"{where} was driven with {largest:.2f} V, but drive.supply in the arm file is {arm.drive.supply:g} V; "
            "correct the supply in the arm file."
        )
    share = float(np.mean(np.abs(voltage) > 0.99 * arm.drive.supply))
    if share > saturated_share:
        return [f"{where} was at full voltage {100 * share:.0f} % of the time; slower motion would tell more."]
    return []


def _refuse_other_period(prepared: Prepared, table: ParameterTable | None, used: NDArray[np.bool_]) -> None:
    """Refuse another period: with a row every tick, the voltage changes once in every control period and at no other
    time.
    """
    log = prepared.log
    stated = log.origin.period_ms
    if table is not None:
        stated = table.period_ms
    if stated is None or prepared.period > 1.5e-3:
        return
    joint = int(np.argmax([np.std(log.voltage[used, joint]) for joint in range(JOINTS)]))
    changes = np.flatnonzero((np.diff(log.voltage[:, joint]) != 0.0) & used[1:] & used[:-1])
    if len(changes) < 20:
        return
    spacing = np.round(np.diff(log.time[changes + 1]) * 1000).astype(int)
    spacing = spacing[(spacing > 0) & (spacing < 200)]
    usual = float(np.median(spacing)) if len(spacing) else float(stated)
    # A lost row shows a change late; most changes still come in whole periods.
    fitting = float(np.mean(spacing % stated == 0)) if len(spacing) else 1.0
    common = int(np.gcd.reduce(spacing)) if len(spacing) else stated
    if (
        usual < stated - 0.5
        or fitting < prepared.limits.checks.fitting_share
        or (common > stated and usual > 1.5 * stated)
    ):
        raise UserError(
            f"{log.name}: joint {joint}: the voltage changes every {usual:g} ms, but the control period is stated as "
            f"{stated} ms; the log is from another controller or period."
        )
