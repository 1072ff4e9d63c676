"""Reads the potentiometers while the motors are off: an open or shorted wire is named before it is a fault."""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import dataclass
from itertools import islice

import numpy as np
from numpy.typing import NDArray

from greywhale import _native
from greywhale.base.errors import UserError
from greywhale.board.device import Device
from greywhale.board.refusal import lower_first, pot_name
from greywhale.board.stream import stream
from greywhale.protocol import schema
from greywhale.protocol.firmware import CONVERSIONS, CONVERTER_COUNTS
from greywhale.protocol.table import ParameterTable

FOLLOWERS = range(4, 8)
POTS = tuple(f"{side}{joint}" for side in ("leader", "follower") for joint in range(4))
LOOK_SAMPLES = 100  # of a millisecond each
FULL_SCALE = CONVERTER_COUNTS - 1
COUNT14_PER_COUNT = 4 * CONVERSIONS  # a reading is the sum of 4 conversions, times 4: 14 bits


@dataclass(frozen=True)
class PotReadings:
    """Counts of the 10-bit converter, one row a sample, columns leader 0..3 and follower 0..3, after the low-pass."""

    counts: NDArray[np.int64]
    rail_counts: int
    there: tuple[int, ...] = tuple(range(len(POTS)))  # the potentiometers that the board has; others show nothing

    def at_rail(self, pot: int) -> schema.Fault:
        """The rail at which a pot reads in any of the samples, else `none`. `rail_counts` 0 turns this off."""
        counts = self.counts[:, pot]
        if self.rail_counts == 0 or pot not in self.there:
            return schema.Fault.NONE
        if np.any(counts <= self.rail_counts):
            return schema.Fault.POT_LOW
        if np.any(counts >= FULL_SCALE - self.rail_counts):
            return schema.Fault.POT_HIGH
        return schema.Fault.NONE

    def complaints(self, pots: Iterable[int] = range(len(POTS))) -> list[str]:
        """A sentence for each of these pots at a rail: which, what it reads, what to do."""
        sentences = []
        for pot in pots:
            if (fault := self.at_rail(pot)) is not schema.Fault.NONE:
                reads = f"{self.counts[:, pot].min()}..{self.counts[:, pot].max()} of {FULL_SCALE}"
                remedy = fault.remedy.removesuffix(", then clear the fault.")
                sentences.append(f"{pot_name(pot)} reads {reads}, at a rail ({fault.key}): {lower_first(remedy)}.")
        return sentences


def read_pots(device: Device, table: ParameterTable) -> PotReadings:
    """Look at all potentiometers for some samples; `table` runs on the board. Its motors must be off.

    Telemetry is off afterwards.
    """
    counts = np.rint(read_counts(device, table, LOOK_SAMPLES))
    return PotReadings(np.clip(counts, 0, FULL_SCALE).astype(np.int64), table["rail_counts"], pots_there(table))


def pots_there(table: ParameterTable) -> tuple[int, ...]:
    """The potentiometers that a board has: their scale is not 0."""
    return tuple(number for number, pot in enumerate(POTS) if table[f"{pot}.scale"] != 0)


def read_counts(device: Device, table: ParameterTable, samples: int) -> NDArray[np.float64]:
    """Readings of the converter, (samples, 8), a row a millisecond, with the fractions that the low-pass leaves.

    `table` runs on the board. Telemetry is off afterwards.
    """
    try:
        taken = [one.sample for one in islice(stream(device, 1), samples)]
    finally:
        device.telemetry(0)
    return counts_of(taken, table)


def counts_of(samples: Iterable[schema.Sample], table: ParameterTable) -> NDArray[np.float64]:
    """(n, 8) counts from the angles in samples, which the board worked out with `table`.

    A potentiometer that is not there, of scale 0, is said to read the middle: nobody knows, and nothing is wrong.
    """
    scales, zeros = ([table[f"{pot}.{key}"] for pot in POTS] for key in ("scale", "zero"))
    angles = [[*sample.leader, *sample.follower] for sample in samples]
    given = np.concatenate([np.ravel(np.asarray(part, dtype=float)) for part in (scales, zeros, angles)])
    return _native.calibration_rule("counts", given)[0].reshape(-1, len(POTS))


def require_good_pots(device: Device, table: ParameterTable, pots: Iterable[int]) -> None:
    """Refuse an arm of which one of these potentiometers is broken before anything is planned for it."""
    for complaint in read_pots(device, table).complaints(pots):
        raise UserError(f"{device.port}: {complaint}")
