"""The way through a calibration: what the person is asked, what is measured meanwhile, what is stored at the end.

The motors stay off but for short weak pulses, which the person is asked for first. Nothing is stored before everything
has been measured and the person has agreed.
"""

from __future__ import annotations

from contextlib import suppress
from dataclasses import dataclass, field

import numpy as np

from greywhale.arm.parameters import USUAL_TRACK_RAD
from greywhale.base.errors import UserError
from greywhale.base.types import Floats
from greywhale.board.calibrate.motors import Motor, examine_motor, remarks
from greywhale.board.calibrate.person import Guide, PersonAnswer, Watch
from greywhale.board.calibrate.solve import Calibration, require_apart
from greywhale.board.calibrate.walk import Walk
from greywhale.board.calibrate.words import HOW_TO_ANSWER, motor_named, motors_asked, poses_asked
from greywhale.board.device import Device, RestartedError, hold_ctrl_c
from greywhale.board.pots import POTS
from greywhale.board.upload import read_parameters, run_set
from greywhale.protocol import schema
from greywhale.protocol.firmware import JOINTS
from greywhale.protocol.joints import ALL, Joints
from greywhale.protocol.table import ParameterTable


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
    if options.second is not None:
        require_apart(options.first, options.second, options.joints)
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
    """Calibrate while `table` runs; `before` is the stored one."""
    watch = Watch(device, table, guide)
    if guide.patient:
        guide.tell(HOW_TO_ANSWER)
    poses = poses_asked(options.first, options.second, options.joints)
    walk = Walk(watch, options.joints, poses, options.track_rad if options.second is None else None)
    found, apart = walk.go()
    if not options.motors:
        return Result(found, before, apart)
    followers = [JOINTS + joint for joint in options.joints]
    while (answer := watch.ask(motors_asked(table.supply_v), followers)[0]) is not PersonAnswer.DONE:
        if answer is PersonAnswer.BACK:
            found, apart = walk.go(walk.length - 1)
    return Result(found, before, apart, _motors(watch, found))


def _motors(watch: Watch, found: Calibration) -> tuple[Motor, ...]:
    calibrated = watch.table.with_raw(found.changes())
    try:
        return tuple(_motor(watch, calibrated, joint, found.joints) for joint in found.joints)
    finally:
        _run_again(watch.device, watch.table)


def _motor(watch: Watch, calibrated: ParameterTable, joint: int, joints: Joints) -> Motor:
    name = motor_named(joint, joints)
    found = examine_motor(
        watch.device, calibrated, joint, lambda volts: watch.guide.show(f"{name}: pulses of {volts:.1f} V")
    )
    watch.guide.tell(f"{name}: {found.volts:.1f} V moved it.")
    return found


def _run_again(device: Device, table: ParameterTable) -> None:
    with hold_ctrl_c(), suppress(RestartedError):  # it runs its stored set again by itself
        run_set(device, table)
