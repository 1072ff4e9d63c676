"""The way through a calibration: what the person is asked, what is measured meanwhile, what is stored at the end.

The motors stay off but for short weak pulses, which the person is asked for first. Nothing is stored before everything
has been measured and the person has agreed.
"""

from __future__ import annotations

from contextlib import suppress
from dataclasses import dataclass, field
from typing import Protocol

import numpy as np
import numpy.typing as npt

from greywhale.board.device import Device, RestartedError, hold_ctrl_c
from greywhale.board.pots import FULL_SCALE, POTS, counts_of, read_counts
from greywhale.board.refusal import pot_name, upper_first
from greywhale.board.stream import stream
from greywhale.board.upload import read_parameters, run_set
from greywhale.calibrate.motors import Motor, examine_motor, remarks
from greywhale.calibrate.solve import Calibration, Pose, match, slipped, solve
from greywhale.calibrate.sweep import Sweep, judge_sweep
from greywhale.errors import UserError
from greywhale.firmware import JOINTS
from greywhale.joints import ALL, Joints
from greywhale.protocol import schema
from greywhale.table import ParameterTable

Floats = npt.NDArray[np.float64]

HELD_TICKS = 500  # that a pose is looked at
STILL_COUNTS = 3.0  # of the mean over a tenth of a second, meanwhile
SHOWN_EVERY = 100  # ticks between two live angles
LONGEST_TICKS = 600_000
TRIES = 3
MOST_APART_RAD = 0.15  # between the arms in the last pose: 9 degrees, more than a hand is wrong by
USUAL_TRACK_RAD = float(np.radians(300.0))
_COUNTS = {2: "two", 4: "four", 6: "six", 8: "eight"}


class Guide(Protocol):
    """The person, or what stands for one."""

    def ask(self, what: str) -> None:
        """Say what to do, to be confirmed when it is done."""

    def show(self, live: str) -> None:
        """Show what is read right now; the next call replaces it."""

    def is_done(self) -> bool:
        """Whether the person has confirmed since `ask`. Raises UserError when nobody ever will."""

    def tell(self, what: str) -> None:
        """Say something that needs no answer."""


@dataclass(frozen=True)
class Options:
    """`first` and `second` are poses (4,) rad; without a second, the tracks' length counts, and one more pose in which
    both arms agree. Of joints that are not in use nothing is asked, and the board is told that they are not.
    """

    first: Floats = field(default_factory=lambda: np.zeros(JOINTS))
    second: Floats | None = None
    track_rad: float = USUAL_TRACK_RAD
    motors: bool = True  # whether to pulse them
    joints: Joints = ALL  # in use


@dataclass(frozen=True)
class Result:
    """The calibration, the table before, how far the arms are apart (4,) rad in a pose from which nothing was worked
    out, and the motors, none where they were not tried.
    """

    calibration: Calibration
    before: ParameterTable
    apart: Floats
    motors: tuple[Motor, ...] = ()

    @property
    def changes(self) -> dict[str, int]:
        """Raw values by parameter name."""
        signs = {
            f"joint{motor.joint}.motor_sign": motor.sign * self.before[f"joint{motor.joint}.motor_sign"]
            for motor in self.motors
        }
        return self.calibration.changes() | signs

    @property
    def reversed(self) -> tuple[str, ...]:
        """The potentiometers that read the other way, which the scale's sign puts right."""
        return tuple(POTS[pot] for pot in self.calibration.pots if self.calibration.scale[pot] < 0.0)

    @property
    def remarks(self) -> tuple[str, ...]:
        """Sentences about what is not wrong enough to refuse it."""
        return remarks(self.motors, self.before.supply_v)

    @property
    def after(self) -> ParameterTable:
        return self.before.with_raw(self.changes)


def calibrate(device: Device, guide: Guide, options: Options) -> Result:
    """Lead a person through the whole calibration; nothing is stored. Raises UserError with the mistakes found."""
    state = device.status().state
    if state not in (schema.State.DISABLED, schema.State.FAULT):
        raise UserError(f"{device.port}: the motors are on; stop them with `greywhale stop` first.")
    table = read_parameters(device)
    if all((table[f"{name}.scale"] != 0) == (pot % JOINTS in options.joints) for pot, name in enumerate(POTS)):
        return _calibrate(device, table, table, guide, options)
    try:
        run_set(device, readable(table, options.joints))
        return _calibrate(device, readable(table, options.joints), table, guide, options)
    finally:
        _run_again(device, table)


def readable(table: ParameterTable, joints: Joints) -> ParameterTable:
    """The set with which the counts of these joints' potentiometers can be read: angles of scale 0 show none.

    Those of the others show nothing, as their inputs are open.
    """
    usual = ParameterTable.defaults()
    scales = {f"{name}.scale": table[f"{name}.scale"] or usual[f"{name}.scale"] for name in POTS}
    scales |= {f"{name}.scale": 0 for pot, name in enumerate(POTS) if pot % JOINTS not in joints}
    return table.with_raw(scales)


def _calibrate(device: Device, table: ParameterTable, before: ParameterTable, guide: Guide, options: Options) -> Result:
    """The same while `table` runs; `before` is the stored one."""
    sweeps = [_sweep(device, table, guide, pot) for pot in range(len(POTS)) if pot % JOINTS in options.joints]
    guide.tell(f"All {_COUNTS[len(sweeps)]} potentiometers turn with their joints.")
    told = _told(options.first, options.joints)
    first = _pose(device, table, guide, options.first, f"Hold both arms in this pose: {told}.")
    if options.second is not None:
        what = f"Now in this pose: {_told(options.second, options.joints)}."
        second = _pose(device, table, guide, options.second, what)
        found = solve(sweeps, first, second, None)
    else:
        found = solve(sweeps, first, None, options.track_rad)
        what = "Now hold both arms in one and the same other pose, every joint at least 20 degrees away."
        second = _pose(device, table, guide, np.zeros(JOINTS), what)
        found = match(found, sweeps, first, second)
    again = _pose(device, table, guide, options.first, f"Once more the first pose: {told}.")
    moved = slipped(first, again)
    if moved:
        raise UserError(" ".join(moved))
    apart = _compare(device, table, found, guide)
    return Result(found, before, apart, _motors(device, table, found, guide) if options.motors else ())


def _compare(device: Device, table: ParameterTable, found: Calibration, guide: Guide) -> Floats:
    """How far the arms are apart (4,) rad in one more pose; the poses before fit by themselves."""
    what = "Last, hold both arms in one and the same third pose, away from the other two."
    angles = found.angles(_pose(device, table, guide, np.zeros(JOINTS), what).counts)
    apart: Floats = np.abs(angles[JOINTS:] - angles[:JOINTS])
    worst = int(np.argmax(apart))
    if apart[worst] > MOST_APART_RAD:
        raise UserError(
            f"{device.port}: held in the same pose, leader and follower differ by {apart[worst]:.2f} rad at joint "
            f"{worst}; hold the poses more exactly, check that no shaft slips, and begin anew."
        )
    return apart


def _motors(device: Device, table: ParameterTable, found: Calibration, guide: Guide) -> tuple[Motor, ...]:
    guide.ask(
        "Each motor now gets short weak pulses, of a tenth to a third of the supply. The board counts on "
        f"{table.supply_v:g} V: if the motors' supply has not, end here and set supply_mv first. Let the follower hang "
        "or lie so that every joint can move by 20 degrees to both sides, switch the motors' supply on, and keep a "
        "hand on its switch."
    )
    _watch(device, table, guide, found.joints[0])
    calibrated = table.with_raw(found.changes())
    try:
        return tuple(examine_motor(device, calibrated, joint) for joint in found.joints)
    finally:
        _run_again(device, table)


def _run_again(device: Device, table: ParameterTable) -> None:
    with hold_ctrl_c(), suppress(RestartedError):  # it runs its stored set again by itself
        run_set(device, table)


def _sweep(device: Device, table: ParameterTable, guide: Guide, pot: int) -> Sweep:
    """Ask until the sweep shows no mistake, a few times at most."""
    joint = pot_name(pot).replace(" potentiometer ", " joint ")
    what = f"Turn {joint}, and no other, slowly to its positive end, then to its negative end, and let it rest."
    for attempt in range(1, TRIES + 1):
        guide.ask(what)
        sweep = judge_sweep(_watch(device, table, guide, pot), pot)
        if not sweep.mistakes:
            return sweep
        if attempt < TRIES:
            guide.tell(" ".join(sweep.mistakes))
    raise UserError(f"{device.port}: {' '.join(sweep.mistakes)}")


def _watch(device: Device, table: ParameterTable, guide: Guide, pot: int) -> Floats:
    """All counts (rows, 8) from now until the person is done."""
    samples = []
    try:
        for one in stream(device, 1):
            samples.append(one.sample)
            if len(samples) % SHOWN_EVERY == 0:
                guide.show(f"{counts_of(samples[-1:], table)[0, pot]:.0f} of {FULL_SCALE}")
                if guide.is_done():
                    break
            if len(samples) > LONGEST_TICKS:
                raise UserError(f"{device.port}: nobody has confirmed for ten minutes; begin anew.")
    finally:
        device.telemetry(0)
    return counts_of(samples, table)


def _pose(device: Device, table: ParameterTable, guide: Guide, angles: Floats, what: str) -> Pose:
    """Ask until both arms are held still."""
    for _ in range(TRIES):
        guide.ask(what)
        _watch(device, table, guide, 0)
        counts = read_counts(device, table, HELD_TICKS)
        means = counts[: HELD_TICKS // 100 * 100].reshape(-1, 100, len(POTS)).mean(axis=1)
        wandered = np.ptp(means, axis=0)
        worst = int(np.argmax(wandered))
        if wandered[worst] <= STILL_COUNTS:
            return Pose(angles, counts.mean(axis=0))
        guide.tell(f"{upper_first(pot_name(worst))} moved by {wandered[worst]:.0f} counts; hold both arms still.")
    raise UserError(f"{device.port}: the arms were not held still; lay them on a support, and begin anew.")


def _told(angles: Floats, joints: Joints) -> str:
    if not angles[list(joints)].any():
        return "every joint at 0"
    return ", ".join(f"joint {joint} at {np.degrees(angles[joint]):.0f} degrees" for joint in joints)
