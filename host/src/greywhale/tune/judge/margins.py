"""Whether a joint comes to rest, whether it still would on a slightly different arm, and whether it moves smoothly.

Different means half or twice the loop gain, one more control period of delay, or softer gear teeth than the model has
(recordings show stiffness least of all, and backlash hunts on it).

The leader makes large moves and stops. From SETTLE_S after each stop on, the follower must not hunt, and its duty must
not chatter. A single overshoot, or creeping to the target, is neither. While the leader moves, in all classes of
training motions, the follower must not rattle, and its duty must not chatter more than a gear that moves bears.
`measure/swings.py` says what each of these words is.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, fields
from typing import Any, TypedDict

import numpy as np

from greywhale.arm import ArmParameters
from greywhale.arm.plants import columns
from greywhale.base.types import Controllers, Flags, Floats, Integers
from greywhale.files.trajectory import Trajectory
from greywhale.loop import Experiment, Result, Timing
from greywhale.loop.leader_motions import minimum_jerk
from greywhale.measure.swings import (
    CHATTER_AT_REST_HZ,
    CHATTER_MOVING_HZ,
    LIMIT_CYCLE,
    RATTLE_MOVING_RAD,
    SEARCH_CYCLE,
    count_swings,
    duty_swings,
    ripple,
)
from greywhale.protocol.firmware import JOINTS, TICK_S
from greywhale.protocol.table import ParameterTable
from greywhale.tune.search.objective import follow, pair_with_plants
from greywhale.tune.search.training import EDGE_S, RATE_HZ, centre, reach, training_motions

SETTLE_S = 1.0
WAIT_S = 0.2

# Loop gains as factors of every joint's torque per volt.
AT_REST = "at rest"
TWICE = "twice the loop gain"
GAINS = {AT_REST: 1.0, "half the loop gain": 0.5, TWICE: 2.0}
DELAY = "one period more delay"
TEETH = "softer gear teeth"
MOVING = "while moving"
SCENARIOS = (*GAINS, TEETH, DELAY, MOVING)
SOFTER, LESS_DAMPED = 4.0, 8.0
# Where the leader stops, as shares of a joint's reach. All joints move together, so all are shaken.
STOPS = (0.8, -0.2)
REST_S = 2.2  # the last 1.2 s of it are judged
REST_LONG_S = 4.0
# A search keeps clear of the border: its gains are further off, and smaller swings and less chatter already cost.
SEARCH_BEYOND = 1.15
SEARCH_CHATTER = 0.7
SEARCH_RIPPLE = 0.9


class MarginFacts(TypedDict):
    scenario: str
    joint: int
    holds: bool
    reversals: int
    chatter_hz: float
    rattle_rad: float  # rms, in motion
    ripple_v: float  # rms, at rest
    plants_failing: int
    plants: int  # that were tried


@dataclass(frozen=True)
class Margin:
    """One joint in one scenario over all plants: the worst of them."""

    scenario: str
    joint: int
    reversals: int  # of the angle within one rest
    chatter_hz: float
    plants_failing: int
    plants: int
    rattle_rad: float = 0.0  # rms; looked at while moving only
    ripple_v: float = 0.0  # rms; looked at in rests only

    @property
    def holds(self) -> bool:
        return self.plants_failing == 0

    def as_dict(self) -> MarginFacts:
        return {
            "scenario": self.scenario,
            "joint": self.joint,
            "holds": self.holds,
            "reversals": self.reversals,
            "chatter_hz": self.chatter_hz,
            "rattle_rad": self.rattle_rad,
            "ripple_v": self.ripple_v,
            "plants_failing": self.plants_failing,
            "plants": self.plants,
        }


@dataclass(frozen=True)
class Unrest:
    """The unrest of every candidate on every plant, per joint: (n, k, 4) each, in the worst rest of the record."""

    reversals: Integers
    hunts: Flags  # turns so often
    travel: Floats  # rad/s, in swings of a limit cycle
    chatter: Floats  # 1/s, duty swings
    ripple: Floats  # V rms
    lost: Flags  # left the range of numbers

    @property
    def fails(self) -> Flags:
        return self.hunts | (self.chatter > CHATTER_AT_REST_HZ) | self.lost


def _part(found: Unrest, plants: slice) -> Unrest:
    return Unrest(*(getattr(found, field.name)[:, plants] for field in fields(found)))


def _together(found: Sequence[Unrest]) -> Unrest:
    return Unrest(*(np.concatenate([getattr(one, field.name) for one in found]) for field in fields(Unrest)))


class Margins:
    """The scenarios on some plants, ready to judge candidates."""

    def __init__(
        self,
        arm: ArmParameters,
        table: ParameterTable,
        plants: Floats,
        *,
        threads: int = 0,
        rest_s: float = REST_S,
        searching: bool = False,
        seed: int = 0,
        noise: int = 0,
    ) -> None:
        low, high = reach(arm, table, plants)
        period = table.period_ms
        motion = stops(low, high, rest_s)
        self.plants = plants
        self._arm, self._table, self._seed = arm, table, 100 * seed + _MOVING_SEED + noise
        self._threads = threads
        self._cycle = SEARCH_CYCLE if searching else LIMIT_CYCLE
        self._beyond = SEARCH_BEYOND if searching else 1.0
        self._rests = rest_ticks(rest_s)
        common: dict[str, Any] = {
            "table": table,
            "seed": noise_seed(seed, noise),
            "wait_s": WAIT_S,
            "soft_start": False,
        }
        self._prompt = Experiment(motion, arm, **common)
        self._late = Experiment(motion, arm, timing=Timing(late=period), **common)
        self._known: dict[bytes, dict[str, Unrest]] = {}  # of controllers that were looked at exactly

    def unrest(self, controllers: Controllers, *, exact: bool = False) -> dict[str, Unrest]:
        """The unrest in every scenario of every candidate (n, 4, 13) on every plant."""
        if not exact:
            return self._unrest(controllers, exact)
        each = []
        for one in controllers:
            key = one.tobytes()
            if key not in self._known:
                self._known[key] = self._unrest(one[None], exact)
            each.append(self._known[key])
        return {name: _together([one[name] for one in each]) for name in each[0]}

    def _unrest(self, controllers: Controllers, exact: bool) -> dict[str, Unrest]:
        """The same, simulated."""
        plants = len(self.plants)
        variants = variants_of(self.plants, self._beyond)
        prompt = self._run(self._prompt, controllers, np.concatenate(list(variants.values())), exact)
        found = {
            name: _part(prompt, slice(number * plants, (number + 1) * plants)) for number, name in enumerate(variants)
        }
        found[DELAY] = self._run(self._late, controllers, self.plants, exact)
        return found

    def _run(self, experiment: Experiment, controllers: Controllers, plants: Floats, exact: bool) -> Unrest:
        laws, arms = pair_with_plants(controllers, plants)
        run = experiment.run_exact if exact else experiment.run
        return self._unrest_of(run(laws, arms, every=1, threads=self._threads), (len(controllers), len(plants)))

    def _unrest_of(self, result: Result, shape: tuple[int, int]) -> Unrest:
        """The worst of the rests in these traces."""
        reversals = np.zeros((*shape, JOINTS), dtype=np.int32)
        travel, chatter, loud = (np.zeros((*shape, JOINTS)) for _ in range(3))
        for rows in self._rests:
            seconds = (rows[1] - rows[0]) * TICK_S
            swings = count_swings(result.angles, *rows, self._cycle.band_rad)
            turned, moved = (one.reshape(*shape, JOINTS) for one in swings)
            beats = duty_swings(result.duties, rows, self._table.board).reshape(*shape, JOINTS)
            hiss = self._table.supply_v * ripple(result.duties, rows, self._table.board).reshape(*shape, JOINTS)
            reversals = np.maximum(reversals, turned)
            travel = np.maximum(travel, np.where(turned >= self._cycle.turns, moved / seconds, 0.0))
            chatter, loud = np.maximum(chatter, beats / seconds), np.maximum(loud, hiss)
        lost = np.repeat(result.diverged.reshape(shape)[:, :, None], JOINTS, axis=2)
        return Unrest(reversals, reversals >= self._cycle.turns, travel, chatter, loud, lost)

    def check(self, controllers: Controllers) -> tuple[Margin, ...]:
        """Check one controller (4, 13) in the bench's own arithmetic: a verdict for each scenario and joint."""
        verdicts = []
        for name, found in self.unrest(controllers[None], exact=True).items():
            for joint in range(JOINTS):
                verdicts.append(
                    Margin(
                        scenario=name,
                        joint=joint,
                        reversals=int(found.reversals[0, :, joint].max()),
                        chatter_hz=float(found.chatter[0, :, joint].max()),
                        ripple_v=float(found.ripple[0, :, joint].max()),
                        plants_failing=int(found.fails[0, :, joint].sum()),
                        plants=found.fails.shape[1],
                    )
                )
        return (*verdicts, *self._check_moving(controllers))

    def _check_moving(self, controllers: Controllers) -> list[Margin]:
        """A verdict for each joint on the training motions, with other sensor noise than in a search."""
        motions = training_motions(self._arm, self._table, self.plants, self._seed)
        found = follow(motions, self.plants, controllers[None], exact=True, threads=self._threads)
        # The worst class counts.
        rattle, chatter = found.rattle[0].max(axis=1), found.chatter[0].max(axis=1)
        failing = (rattle >= RATTLE_MOVING_RAD) | (chatter > CHATTER_MOVING_HZ)
        return [
            Margin(
                scenario=MOVING,
                joint=joint,
                reversals=0,
                chatter_hz=float(chatter[:, joint].max()),
                plants_failing=int(failing[:, joint].sum()),
                plants=len(self.plants),
                rattle_rad=float(rattle[:, joint].max()),
            )
            for joint in range(JOINTS)
        ]


_MOVING_SEED = 50  # of sensor noise that no search hears
# The leader rests this long before its first move.
_FIRST_S = 0.2
# What a search pays, as shares of what is possible: for a limit cycle, for each rad/s of swinging in it, and for each
# CHATTER_AT_REST_HZ of chatter; for ripple at rest as a share of what is allowed, and for what is beyond that.
TRAVEL_PRICE = 0.5
CHATTER_PRICE = 0.03
FAIL_PRICE = 0.15
TEETH_PRICE = 0.08  # of a failure with softer teeth: what no recording shows well is no reason to follow badly
RIPPLE_PRICE = 0.05
LOUD_PRICE = 1.0
LOST_PRICE = 10.0


def penalty(found: dict[str, Unrest], quiet_v: Floats, fail_price: float = FAIL_PRICE) -> Floats:
    """What candidates pay (n, 4), mostly for scenarios that fail; `quiet_v` (4,) is the ripple that is allowed."""
    share = found[AT_REST].ripple.mean(axis=1) / quiet_v
    total = RIPPLE_PRICE * share + LOUD_PRICE * np.maximum(share - SEARCH_RIPPLE, 0.0)
    for scenario, one in found.items():
        fails = (TEETH_PRICE if scenario == TEETH else fail_price) * one.fails
        excess = np.maximum(one.chatter / CHATTER_AT_REST_HZ - SEARCH_CHATTER, 0.0)
        price = TRAVEL_PRICE * one.travel + CHATTER_PRICE * excess + fails + LOST_PRICE * one.lost
        total = total + price.mean(axis=1)
    return np.asarray(total, dtype=np.float64)


def noise_seed(seed: int, noise: int) -> int:
    """The seed of the sensor noise in rests; each `noise` is another one."""
    return 100 * seed + 31 + 2 * noise


def rest_ticks(rest_s: float) -> list[tuple[int, int]]:
    """The first tick of each rest that is judged, and the first after it."""
    return [
        (round(1e3 * (WAIT_S + (number + 1) * rest_s - rest_s + _FIRST_S + EDGE_S + SETTLE_S)),
         round(1e3 * (WAIT_S + _FIRST_S + (number + 1) * rest_s)))
        for number in range(len(STOPS))
    ]  # fmt: skip


def variants_of(plants: Floats, beyond: float) -> dict[str, Floats]:
    """The same plants in each scenario in which the arm differs, with gains further off by a factor."""
    gains = {
        name: gain if gain == 1.0 else gain * beyond if gain > 1.0 else gain / beyond for name, gain in GAINS.items()
    }
    variants = {name: with_gain(plants, gain) for name, gain in gains.items()}
    return {**variants, TEETH: with_softer_teeth(plants)}


def with_gain(plants: Floats, factor: float) -> Floats:
    """The same plants with another torque per volt on every joint."""
    scaled = plants.copy()
    scaled[:, columns("torque_per_volt")] *= factor
    return scaled


def with_softer_teeth(plants: Floats) -> Floats:
    """The same plants with softer gear teeth that damp less; rigid gears stay rigid."""
    softer = plants.copy()
    softer[:, columns("stiffness")] /= SOFTER
    softer[:, columns("mesh_damping")] /= LESS_DAMPED
    return softer


def stops(low: Floats, high: Floats, rest_s: float) -> Trajectory:
    """Small moves of all joints and a rest after each."""
    middle, size = centre(low, high)
    total = _FIRST_S + rest_s * len(STOPS)
    time_s = np.arange(round(total * RATE_HZ) + 1) / RATE_HZ
    path = np.zeros(len(time_s))
    before = 0.0
    for number, place in enumerate(STOPS):
        path += (place - before) * minimum_jerk((time_s - _FIRST_S - number * rest_s) / EDGE_S)
        before = place
    return Trajectory(time_s, middle + size * path[:, None])
