"""Judges a joint's measures on the arm by those from before: does it hunt, rattle, chatter, hiss or follow worse?"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, field

import numpy as np

from greywhale.base.types import Flags, Floats
from greywhale.commission.limits import COMMISSIONING_LIMITS, CommissioningLimits
from greywhale.commission.measures import HAND_LED, HOLDING, Measures
from greywhale.commission.motions import PARTS
from greywhale.measure.limits import AllowedSwings
from greywhale.protocol.firmware import JOINTS

# Where a joint hardly moves, friction and play make its error.
HARDLY_MOVED = [PARTS.index(name) for name in ("small moves", HOLDING)]
# While a joint holds still, quicker neighbours push it; that it rests by itself shows after its own moves.
PUSHED = PARTS.index(HOLDING)
# A joint that is led slowly sticks and slips, a stiffer one more often: at 15 Hz what was at 5 Hz before, below the
# band of rattling. So twice what was seen before says little here.
SLOW = PARTS.index("slow motion")
# The parts whose error ranks controllers as a person's reaches do (docs/commission.md). In the others it has a limit.
LED = [PARTS.index(name) for name in HAND_LED]
RESTLESS = ("unrest", "rattle", "chatter", "ripple")
LEAST_RAD2 = 1e-9  # keeps a division from 0


@dataclass(frozen=True)
class Limits:
    """The most that a joint may do in each part of the check, (parts, 4) each.

    Each part has limits of its own: a joint that its neighbours push while it holds still may show several mrad there,
    and must rest after its own moves all the same.
    """

    unrest: Floats
    rattle: Floats
    chatter: Floats
    ripple: Floats
    error: Floats

    @classmethod
    def of(
        cls,
        before: Measures,
        kept: Flags,
        quiet_v: float,
        judging: CommissioningLimits = COMMISSIONING_LIMITS,
    ) -> Limits:
        """Allow whatever was there before, and ripple of `quiet_v`. `kept` (4,) marks joints whose
        controllers are those from before: they are no worse controllers, so what nobody sees never counts against
        them.
        """
        own, swings = judging.judge, judging.swings
        share = np.where(kept, own.kept_share, swings.repeat_share)
        unseen_rad = np.tile(np.where(kept, own.unseen_rad, own.repeat_rad), (len(PARTS), 1))
        unseen_rad[HARDLY_MOVED], unseen_rad[PARTS.index(HOLDING)] = own.unseen_rad, own.unseen_holding_rad
        error = np.maximum((1.0 + share) * before.error, (np.sqrt(before.error) + unseen_rad) ** 2)
        growth = np.tile(np.where(kept, own.kept_growth, swings.unrest_growth), (len(PARTS), 1))
        least = np.full((len(PARTS), 1), swings.unseen_unrest_rad)
        growth[PUSHED], least[PUSHED] = own.kept_growth, own.pushed_rad
        least_rattle = np.full((len(PARTS), 1), swings.unseen_rattle_rad)
        least_rattle[SLOW] = swings.bounds.rattle_moving_rad
        most = AllowedSwings.beside(
            before.unrest, before.rattle, before.chatter, before.ripple, quiet_v, swings,
            growth=growth, unseen_unrest=least, unseen_rattle=least_rattle,
        )  # fmt: skip
        return cls(most.unrest, most.rattle, most.chatter, most.ripple, error)


@dataclass(frozen=True)
class TrialVerdict:
    """One joint in one trial: `faults` are clauses, empty where it passed; `score` is its error relative to before."""

    joint: int
    faults: tuple[str, ...]
    restless: bool  # one of the faults is unrest, rattling, chatter or ripple
    hunts: bool  # does not come to rest after its moves, or ended the trial
    excess: float  # how many times these are what they may be; inf where it ended the trial
    score: float  # in what a hand leads, as far as it was played; NaN where it was not, 0 for one not in use
    share: float  # of all joints' error there, with the controllers from before
    known: bool  # whether the joint can be judged: this joint ended the check, or was seen where a hand leads
    passes_at_a_price: bool  # whether it passed, or has no other fault than a little too much of one of these, as seen
    judging: CommissioningLimits = field(default=COMMISSIONING_LIMITS, repr=False, compare=False)

    @property
    def passed(self) -> bool:
        return self.known and not self.faults

    @property
    def ranking_cost(self) -> float:
        """The cost that joints and sets are chosen by, less is better: the score, dearer with what has to be borne."""
        if not self.passes_at_a_price:
            return float("inf")
        above = 0.0 if self.passed else (self.excess - 1.0) / (self.judging.swings.bearable_excess - 1.0)
        return self.score * float(self.judging.judge.bearable_price**above)


def judge(
    measured: Measures,
    before: Measures,
    limits: Limits,
    guilty: Sequence[str],
    foreseen: Sequence[str] = ("",) * JOINTS,
    judging: CommissioningLimits = COMMISSIONING_LIMITS,
) -> tuple[TrialVerdict, ...]:
    """A verdict for every joint; `guilty` has a clause for each joint that ended the trial, `foreseen` for each that a
    model speaks against, "" for the others.
    """
    return tuple(
        _judge(measured, before, limits, joint, guilty[joint], foreseen[joint], judging) for joint in range(JOINTS)
    )


def _judge(
    measured: Measures,
    before: Measures,
    limits: Limits,
    joint: int,
    guilty: str,
    foreseen: str,
    judging: CommissioningLimits,
) -> TrialVerdict:
    faults = [guilty] if guilty else []
    unrest, rattle, chatter, ripple = (_closest(measured, limits, name, joint) for name in RESTLESS)
    excess = np.inf if guilty else max(0.0, unrest.share, rattle.share, chatter.share, ripple.share)
    if not guilty and unrest.share > 1.0:
        faults.append(f"it hunts at rest ({1e3 * unrest.value:.1f} mrad rms, at most {1e3 * unrest.limit:.1f})")
    if rattle.share > 1.0:
        faults.append(f"it rattles in motion ({1e3 * rattle.value:.1f} mrad rms, at most {1e3 * rattle.limit:.1f})")
    if chatter.share > 1.0:
        faults.append(f"its voltage chatters ({chatter.value:.0f} times a second)")
    if ripple.share > 1.0:
        faults.append(f"it hisses at rest ({ripple.value:.2f} V rms above 20 Hz, at most {ripple.limit:.2f})")
    restless = bool(faults)
    for place, part in enumerate(PARTS):
        if measured.error[place, joint] > limits.error[place, joint]:
            ratio = measured.error[place, joint] / before.error[place, joint]
            faults.append(f"it follows {part} worse than before ({ratio:.2g} times the error)")
    if foreseen:
        faults.append(foreseen)
    was, seen = before.error[LED], np.isfinite(measured.error[LED, joint])
    shown = measured.error[LED, joint][seen].sum() / max(was[seen, joint].sum(), LEAST_RAD2)
    score = float(shown) if seen.any() else np.nan
    share = float(was[:, joint].sum() / max(was.sum(), LEAST_RAD2))
    known = bool(seen.any() or faults)
    hardly = restless and len(faults) == 1 and excess <= judging.swings.bearable_excess
    priced = bool(seen.any()) and (hardly or not faults)
    hunts = bool(guilty) or unrest.share > 1.0
    return TrialVerdict(joint, tuple(faults), restless, hunts, excess, score, share, known, priced, judging)


@dataclass(frozen=True)
class _Closest:
    """A measure in the part in which it comes closest to its limit, or is farthest above; NaN where it has none."""

    value: float = np.nan
    limit: float = np.nan

    @property
    def share(self) -> float:
        return self.value / self.limit if np.isfinite(self.value) else 0.0


def _closest(measured: Measures, limits: Limits, name: str, joint: int) -> _Closest:
    values, most = getattr(measured, name)[:, joint], getattr(limits, name)[:, joint]
    known = np.isfinite(values)
    if not known.any():
        return _Closest()
    part = int(np.argmax(np.where(known, values / most, -np.inf)))
    return _Closest(float(values[part]), float(most[part]))
