"""Potentiometers that read at a rail: a wire is open or shorted. The board itself refuses to start the motors then.

The samples hold angles, so the readings are worked out from the board's own table. A leader's angles end at the joint's
limits: where those lie before the rail, only the board sees a broken potentiometer of the leader.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from greywhale.board.device import Device
from greywhale.board.refusal import lower_first, pot_name
from greywhale.board.stream import stream
from greywhale.errors import UserError
from greywhale.protocol import schema
from greywhale.table import ParameterTable

FOLLOWERS = range(4, 8)
_SAMPLES = 9
_FULL_SCALE = 1023
# angle = (16 x the 10-bit count - zero) x scale / 2^13
_FINE, _SCALE_LSB = 16, 8192
# A board rounds and filters; a good joint is further from a rail than this, in counts.
_SLACK = 1.0


@dataclass(frozen=True)
class BadPot:
    """A potentiometer, 0..3 of the leader and 4..7 of the follower, at a rail: pot_low or pot_high."""

    number: int
    fault: schema.Fault

    def as_dict(self) -> dict[str, object]:
        return {"pot": pot_name(self.number), "fault": self.fault.key}

    def __str__(self) -> str:
        what = self.fault.description.removeprefix("a potentiometer ")
        remedy = self.fault.remedy.replace(", then clear the fault", "")  # there is none yet
        return f"{pot_name(self.number)} {what}: {lower_first(remedy)}"


def bad_pots(device: Device, table: ParameterTable) -> list[BadPot]:
    """The potentiometers that read at a rail now; `table` runs on the board."""
    received = stream(device, 1)
    angles = [[*sample.leader, *sample.follower] for sample in (next(received).sample for _ in range(_SAMPLES))]
    device.telemetry(0)
    margin = table["rail_counts"]
    found = []
    for number, angle in enumerate(np.median(np.array(angles), axis=0).tolist()):
        pot = f"leader{number}" if number < 4 else f"follower{number - 4}"
        count = (angle * _SCALE_LSB / table[f"{pot}.scale"] + table[f"{pot}.zero"]) / _FINE
        if margin and count < margin + _SLACK:
            found.append(BadPot(number, schema.Fault.POT_LOW))
        elif margin and count > _FULL_SCALE - margin - _SLACK:
            found.append(BadPot(number, schema.Fault.POT_HIGH))
    return found


def require_good_pots(device: Device, table: ParameterTable, numbers: range = range(8)) -> None:
    """Refuse an arm with a broken potentiometer among these before anything is planned for it."""
    for pot in bad_pots(device, table):
        if pot.number in numbers:
            raise UserError(f"{device.port}: {pot}")
