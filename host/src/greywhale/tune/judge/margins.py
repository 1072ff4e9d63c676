"""The margins of a joint: it comes to rest, it still would on a slightly different arm, and it moves smoothly.

Different means half or twice the loop gain, one more control period of delay, or softer gear teeth than the model has
(recordings show stiffness least of all, and backlash hunts on it).

The leader makes large moves and stops. From `settle_s` after each stop on, the follower must not hunt, and its duty
must not chatter. A single overshoot, or creeping to the target, is neither. While the leader moves, in all classes of
training motions, the follower must not rattle, and its duty must not chatter more than a gear that moves bears.
`measure/swings.py` says what each of these words is.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any, TypedDict

import numpy as np

from greywhale import _native
from greywhale.arm import ArmParameters
from greywhale.arm.plants import columns
from greywhale.base.limits import numbers_in
from greywhale.base.types import Controllers, Flags, Floats, Integers
from greywhale.files.trajectory import Trajectory
from greywhale.loop import Experiment, Timing
from greywhale.loop.leader_motions import RATE_HZ, minimum_jerk
from greywhale.measure.swings import FOR_SIMULATIONS
from greywhale.protocol.firmware import JOINTS, pwm_steps
from greywhale.protocol.table import ParameterTable
from greywhale.tune.limits import TUNING_LIMITS, MarginLimits, TuningLimits
from greywhale.tune.search.objective import follow, pair_with_plants
from greywhale.tune.search.training import WAIT_S, centre, reach, training_motions

_MOVING_SEED = 50  # of sensor noise that no search hears

# Loop gains are factors of every joint's torque per volt.
AT_REST = "at rest"
HALF = "half the loop gain"
TWICE = "twice the loop gain"
DELAY = "one period more delay"
TEETH = "softer gear teeth"
MOVING = "while moving"
SCENARIOS = (AT_REST, HALF, TWICE, TEETH, DELAY, MOVING)  # as Scenario in host/native/score/unrest.h


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
    """The unrest of every candidate on every plant, per joint: (n, k, 4) each, in the worst rest; the ripple in all."""

    numbers: Floats  # (n, k, 4, 6), in the order of Unrest in host/native/score/unrest.h

    @property
    def reversals(self) -> Integers:
        return self.numbers[..., 0].astype(np.int32)

    @property
    def travel(self) -> Floats:
        """In swings of a limit cycle, rad/s."""
        return self.numbers[..., 1]

    @property
    def chatter(self) -> Floats:
        """Duty swings, 1/s."""
        return self.numbers[..., 2]

    @property
    def ripple(self) -> Floats:
        """V rms."""
        return self.numbers[..., 3]

    @property
    def fails(self) -> Flags:
        """Hunts, chatters or is lost."""
        return np.asarray(self.numbers[..., 4] != 0.0)

    @property
    def lost(self) -> Flags:
        """Left the range of numbers."""
        return np.asarray(self.numbers[..., 5] != 0.0)


class Margins:
    """The scenarios on some plants, ready to judge candidates."""

    def __init__(
        self,
        arm: ArmParameters,
        table: ParameterTable,
        plants: Floats,
        *,
        threads: int = 0,
        rest_s: float | None = None,
        searching: bool = False,
        seed: int = 0,
        noise: int = 0,
        judging: TuningLimits = TUNING_LIMITS,
    ) -> None:
        """Rests last `rest_s`, or as long as in the first search."""
        low, high = reach(arm, table, plants, judging.training)
        period, limits = table.period_ms, judging.margins
        rest_s = limits.rest_s if rest_s is None else rest_s
        motion = stops(low, high, rest_s, judging)
        self._judging = judging
        self.plants = plants
        self._arm, self._table, self._seed = arm, table, 100 * seed + _MOVING_SEED + noise
        self._threads = threads
        self._cycle = judging.swings.search_cycle if searching else judging.swings.limit_cycle
        self._beyond = limits.search_beyond if searching else 1.0
        self._rests = rest_ticks(rest_s, judging)
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
        return {name: Unrest(np.concatenate([one[name].numbers for one in each])) for name in each[0]}

    def _unrest(self, controllers: Controllers, exact: bool) -> dict[str, Unrest]:
        """Simulate the unrest in every scenario of every candidate on every plant."""
        plants = len(self.plants)
        variants = variants_of(self.plants, self._beyond, self._judging.margins)
        prompt = self._run(self._prompt, controllers, np.concatenate(list(variants.values())), exact)
        found = {
            name: Unrest(prompt.numbers[:, number * plants : (number + 1) * plants])
            for number, name in enumerate(variants)
        }
        found[DELAY] = self._run(self._late, controllers, self.plants, exact)
        return found

    def _run(self, experiment: Experiment, controllers: Controllers, plants: Floats, exact: bool) -> Unrest:
        laws, arms = pair_with_plants(controllers, plants)
        run = experiment.run_exact if exact else experiment.run
        found = _native.unrest(
            result=run(laws, arms, every=1, threads=self._threads),
            pwm_top=pwm_steps(self._table.board),
            rests=self._rests,
            band_rad=self._cycle.band_rad,
            turns=self._cycle.turns,
            supply_v=self._table.supply_v,
            swings=numbers_in(self._judging.swings),
            measure=FOR_SIMULATIONS,
        )
        return Unrest(np.asarray(found).reshape(len(controllers), len(plants), JOINTS, -1))

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
        judging = self._judging
        motions = training_motions(self._arm, self._table, self.plants, self._seed, judging.training)
        found = follow(motions, self.plants, controllers[None], exact=True, threads=self._threads, limits=judging.cost)
        # The worst class counts.
        rattle, chatter = found.rattle[0].max(axis=1), found.chatter[0].max(axis=1)
        failing = (rattle >= judging.swings.rattle_moving_rad) | (chatter > judging.swings.chatter_moving_hz)
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


def penalty(found: Mapping[str, Unrest], quiet_v: Floats, judging: TuningLimits = TUNING_LIMITS) -> Floats:
    """Price candidates (n, 4), mostly for scenarios that fail; `quiet_v` (4,) is the ripple that is allowed."""
    prices = _native.unrest_prices(
        scenarios=[SCENARIOS.index(name) for name in found],
        unrest=np.stack([one.numbers for one in found.values()]),
        quiet_v=quiet_v.tolist(),
        margins=numbers_in(judging.margins),
    )
    return np.asarray(prices)


def noise_seed(seed: int, noise: int) -> int:
    """The seed of the sensor noise in rests; each `noise` is another one."""
    return 100 * seed + 31 + 2 * noise


def rest_ticks(rest_s: float, judging: TuningLimits = TUNING_LIMITS) -> list[tuple[int, int]]:
    """The first tick of each rest that is judged, and the first after it."""
    limits, edge_s = judging.margins, judging.training.edge_s
    return [
        (round(1e3 * (WAIT_S + (number + 1) * rest_s - rest_s + limits.first_s + edge_s + limits.settle_s)),
         round(1e3 * (WAIT_S + limits.first_s + (number + 1) * rest_s)))
        for number in range(len(limits.stop_shares))
    ]  # fmt: skip


def variants_of(plants: Floats, beyond: float, limits: MarginLimits = TUNING_LIMITS.margins) -> dict[str, Floats]:
    """Return the plants in each scenario in which the arm differs, with gains further off by a factor."""
    gains = {AT_REST: 1.0, HALF: limits.half_gain / beyond, TWICE: limits.twice_gain * beyond}
    variants = {name: with_gain(plants, gain) for name, gain in gains.items()}
    return {**variants, TEETH: with_softer_teeth(plants, limits)}


def with_gain(plants: Floats, factor: float) -> Floats:
    """Return the plants with another torque per volt on every joint."""
    scaled = plants.copy()
    scaled[:, columns("torque_per_volt")] *= factor
    return scaled


def with_softer_teeth(plants: Floats, limits: MarginLimits = TUNING_LIMITS.margins) -> Floats:
    """Return the plants with softer gear teeth that damp less; rigid gears stay rigid."""
    softer = plants.copy()
    softer[:, columns("stiffness")] /= limits.teeth_stiffness_divisor
    softer[:, columns("mesh_damping")] /= limits.teeth_damping_divisor
    return softer


def stops(low: Floats, high: Floats, rest_s: float, judging: TuningLimits = TUNING_LIMITS) -> Trajectory:
    """Small moves of all joints and a rest after each."""
    middle, size = centre(low, high, judging.training)
    first_s, shares = judging.margins.first_s, judging.margins.stop_shares
    total = first_s + rest_s * len(shares)
    time_s = np.arange(round(total * RATE_HZ) + 1) / RATE_HZ
    path = np.zeros(len(time_s))
    before = 0.0
    for number, place in enumerate(shares):
        path += (place - before) * minimum_jerk((time_s - first_s - number * rest_s) / judging.training.edge_s)
        before = place
    return Trajectory(time_s, middle + size * path[:, None])
