"""From sweeps and held poses to zero, scale and limits, as the board stores them.

angle = scale x (count14 - zero), count14 = 16 counts (docs/link.md). The sweeps give the sign of each scale, a pose
with known angles gives the zeros. The size of the scales comes from a second known pose, or from the tracks' length.
Two arms held in the same pose must agree: what counts is that the follower does as the leader, not a degree of both.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np

from greywhale.base.errors import BadUsage, UserError
from greywhale.base.types import Floats
from greywhale.board.calibrate.sweep import Sweep
from greywhale.board.pots import COUNT14_PER_COUNT, FULL_SCALE, POTS
from greywhale.board.refusal import pot_name, upper_first
from greywhale.protocol import schema
from greywhale.protocol.firmware import JOINTS
from greywhale.protocol.joints import ALL, Joints

SHORTEST_TRACK_RAD, LONGEST_TRACK_RAD = np.radians(180.0), np.radians(450.0)  # the board takes no longer one
LEAST_TURN_RAD = 0.3  # rad between two poses: with less, a degree in a hand is much of the scale
SLIPPED_COUNTS = 8.0  # the same pose twice: 40 mrad of a usual track
MARGIN_RAD = 0.03  # kept from both ends of what the person showed


@dataclass(frozen=True)
class Pose:
    """Both arms held still: `angles` (4,) rad, the same for both arms, and `counts` (8,)."""

    angles: Floats
    counts: Floats


@dataclass(frozen=True)
class Calibration:
    """`zero` (8,) counts, `scale` (8,) rad a count, `limits` (4, 2) rad; columns leader 0..3, follower 0..3.

    What it says of joints that are not in use means nothing.
    """

    zero: Floats
    scale: Floats
    limits: Floats
    joints: Joints = ALL

    @property
    def pots(self) -> tuple[int, ...]:
        return tuple(pot for pot in range(len(POTS)) if pot % JOINTS in self.joints)

    def angles(self, counts: Floats) -> Floats:
        """(..., 8) rad of counts (..., 8)."""
        return (counts - self.zero) * self.scale

    def changes(self) -> dict[str, int]:
        """Raw values by parameter name; a joint that is not in use gets a scale of 0 at both arms. Raises UserError
        where a value does not fit.
        """
        values: dict[str, float] = {}
        for pot, name in enumerate(POTS):
            if pot in self.pots:
                values[f"{name}.zero"] = COUNT14_PER_COUNT * self.zero[pot]
            values[f"{name}.scale"] = self.scale[pot] / COUNT14_PER_COUNT if pot in self.pots else 0.0
        for joint in self.joints:
            values[f"joint{joint}.limit_min"], values[f"joint{joint}.limit_max"] = self.limits[joint]
        return {name: _raw(name, value) for name, value in values.items()}


def solve(sweeps: Sequence[Sweep], first: Pose, second: Pose | None, track_rad: float | None) -> Calibration:
    """The calibration from a sweep of every potentiometer, a known pose, and a second known pose or the tracks' length.

    The joints that were swept are those in use. Raises UserError where sweeps and poses contradict each other.
    """
    signs = np.ones(len(POTS))
    for sweep in sweeps:
        signs[sweep.pot] = sweep.direction
    if second is not None:
        scale = _between(first, second, signs, sorted(sweep.pot for sweep in sweeps))
    elif track_rad is not None:
        scale = signs * track_rad / FULL_SCALE
    else:
        raise UserError("neither a second pose nor the tracks' length is known; give one of them.")
    zero: Floats = first.counts - np.tile(first.angles, 2) / scale
    found = Calibration(zero, scale, np.zeros((JOINTS, 2)), tuple(sorted({sweep.pot % JOINTS for sweep in sweeps})))
    return replace(found, limits=_limits(found, sweeps))


def match(calibration: Calibration, sweeps: Sequence[Sweep], first: Pose, same: Pose) -> Calibration:
    """Let the follower agree with the leader in a pose whose angles nobody knows; `same.angles` are not used."""
    leader = calibration.angles(same.counts)[:JOINTS]
    turned = leader - first.angles
    moved = same.counts[JOINTS:] - first.counts[JOINTS:]
    scale = calibration.scale.copy()
    for joint in calibration.joints:
        if abs(turned[joint]) >= LEAST_TURN_RAD:
            scale[JOINTS + joint] = turned[joint] / moved[joint]
    zero = calibration.zero.copy()
    zero[JOINTS:] = first.counts[JOINTS:] - first.angles / scale[JOINTS:]
    found = replace(calibration, zero=zero, scale=scale)
    return replace(found, limits=_limits(found, sweeps))


def slipped(before: Pose, after: Pose) -> list[str]:
    """A sentence for each potentiometer that reads something else where the same pose is held again."""
    apart = np.abs(after.counts - before.counts)
    return [
        f"{upper_first(pot_name(pot))} reads {apart[pot]:.0f} counts elsewhere in the same pose: it "
        "slips on its shaft; tighten it, and begin anew."
        for pot in range(len(POTS))
        if apart[pot] > SLIPPED_COUNTS
    ]


def require_apart(first: Floats, second: Floats, joints: Sequence[int]) -> None:
    """Refuse two poses (4,), rad, from which no scale can be told."""
    for joint in joints:
        turned = second[joint] - first[joint]
        if abs(turned) < LEAST_TURN_RAD:
            raise BadUsage(
                f"the two poses differ by {turned:.2g} rad at joint {joint}; choose a second pose that differs by "
                f"{LEAST_TURN_RAD:g} rad or more at every joint."
            )


def _between(first: Pose, second: Pose, signs: Floats, pots: Sequence[int]) -> Floats:
    """Scales of these potentiometers from two poses; they must agree with the directions of the sweeps."""
    require_apart(first.angles, second.angles, sorted({pot % JOINTS for pot in pots}))
    turned = np.tile(second.angles - first.angles, 2)
    moved = second.counts - first.counts
    scale = np.ones(len(POTS))
    for pot in pots:
        name = pot_name(pot)
        track = abs(turned[pot] / moved[pot]) * FULL_SCALE if moved[pot] else np.inf
        if not SHORTEST_TRACK_RAD <= track <= LONGEST_TRACK_RAD:
            raise UserError(
                f"{name} read {first.counts[pot]:.0f} and {second.counts[pot]:.0f} in the two poses: as if its track "
                f"had {np.degrees(track):.0f} degrees; hold the poses again, and check that its shaft does not slip."
            )
        scale[pot] = turned[pot] / moved[pot]
        if np.sign(scale[pot]) != signs[pot]:
            raise UserError(
                f"{name} turned the other way between the poses than in its sweep; in the sweep, turn towards the "
                "positive end first."
            )
    return scale


def _limits(found: Calibration, sweeps: Sequence[Sweep]) -> Floats:
    """(4, 2): what both arms can reach, without the margin."""
    ends = np.zeros((len(POTS), 2))
    for sweep in sweeps:
        pair = (np.array([sweep.low, sweep.high]) - found.zero[sweep.pot]) * found.scale[sweep.pot]
        ends[sweep.pot] = np.sort(pair)
    low = np.maximum(ends[:JOINTS, 0], ends[JOINTS:, 0]) + MARGIN_RAD
    high = np.minimum(ends[:JOINTS, 1], ends[JOINTS:, 1]) - MARGIN_RAD
    for joint in found.joints:
        if low[joint] >= high[joint]:
            raise UserError(
                f"joint {joint} has no range that both arms can reach: the leader goes from {ends[joint, 0]:.2f} to "
                f"{ends[joint, 1]:.2f} rad, the follower from {ends[JOINTS + joint, 0]:.2f} to "
                f"{ends[JOINTS + joint, 1]:.2f}; hold both arms in the same pose, and sweep to both ends."
            )
    return np.column_stack([low, high])


def _raw(name: str, value: float) -> int:
    parameter = schema.PARAMETER_BY_NAME[name]
    low, high = (parameter.to_physical(raw) for raw in (parameter.minimum, parameter.maximum))
    if name.endswith(("limit_min", "limit_max")):
        value = min(max(value, low), high)
    if not low <= value <= high:
        raise UserError(f"{name} would be {value:.6g}, but it must lie within {low:.6g}..{high:.6g}; begin anew.")
    return parameter.to_raw(value)
