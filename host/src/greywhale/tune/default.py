"""The default method: GWO-WOA in stages. Any other optimiser can take its place, by its name.

1. `shape`: one search a joint (`search/lockstep.py`) for sets that are the same on both sides of zero. It runs over
   several plants and all training motions, each class of them counted by what is possible in it (`possible.py`).
   Unrest costs extra. Joints 0 and 2 take turns with 1 and 3, because neighbours disturb each other. Once the packs
   are close around the best, all joints search at the same time.
2. `shape again`, twice: fresh packs, ever closer around the best so far. What neighbours did counts in a joint's cost,
   and by now they do better. So everything is judged anew.
3. `every corner`: a narrow search from there, in which each corner and factor is free.
4. The best few of every joint are judged anew, on all plants and with other noise (`judge/choose.py`). The controller
   from before the tuning competes too, and the bench's own arithmetic has the last word, so no joint ends worse than it
   began. A joint that falls short there, or follows some motions less closely, is searched once more.

Margins are looked at on the search's two plants alone. Of many drawn arms the softest would decide, and it is softer
than the arm by more than recordings err.
"""

from __future__ import annotations

import hashlib
from collections.abc import Sequence
from dataclasses import dataclass, replace
from functools import partial
from typing import Any

import numpy as np

from greywhale.arm.parameters import with_usual_noise
from greywhale.base.errors import counted
from greywhale.base.types import Controllers, Flags, Floats
from greywhale.measure.limits import SwingBounds
from greywhale.optimise.optimiser import PACK
from greywhale.optimise.shift_invariant import ShiftInvariantWolfWhale
from greywhale.protocol.joints import unused
from greywhale.protocol.table import CONTROLLER_COLUMNS
from greywhale.tune.judge.choose import CachedJudge, Judge, choose, next_best
from greywhale.tune.judge.following import FollowingBefore, worse_followers
from greywhale.tune.judge.held_out import judge_held_out
from greywhale.tune.judge.margins import MOVING, Margin, Margins, penalty
from greywhale.tune.judge.standard import Standard, hunting_everywhere
from greywhale.tune.method import Costs, Judgement
from greywhale.tune.model import Model
from greywhale.tune.possible import scale_of
from greywhale.tune.request import TuningRequest
from greywhale.tune.search.journal import TuningJournal
from greywhale.tune.search.lockstep import KEPT, TOGETHER, TURNS, LockstepSearch, SearchState
from greywhale.tune.search.objective import Objective
from greywhale.tune.search.space import Space
from greywhale.tune.search.training import TrainingMotion, abrupt_moves, own_motion, training_motions

BUDGET = 2400  # unless somebody asks for another
METHOD = ShiftInvariantWolfWhale.name  # of the default method


@dataclass(frozen=True)
class Stage:
    """One search of the default method, from the best so far."""

    name: str
    share: float  # of the budget
    sigma: float | None  # of the first pack, as a share of the box; None: all over it
    groups: Sequence[Sequence[int]]  # of joints that search at the same time
    every_corner: bool = False


STAGES = (
    Stage("shape", 0.25, None, TURNS),
    Stage("shape again", 0.25, 0.15, TURNS),
    Stage("shape at last", 0.2, 0.05, TOGETHER),
    Stage("every corner", 0.3, 0.03, TOGETHER, every_corner=True),
)
# What joints get that fall short in the last judgement, beyond the budget.
AGAIN = Stage("again", 0.06, 0.05, TOGETHER)
# The search tracks on so many plants, the estimate first; of the last judgement, the errors use all.
SEARCH_PLANTS = 2
FULL_PACK = 16  # on two plants: that fills the lanes of the simulation twice
SHORT_BUDGET = 1000  # evaluations; below that, more rounds of a smaller pack find more
JUDGING_SEED = 1000  # of sensor noise that the search does not know by heart
KU, KI = (CONTROLLER_COLUMNS.index(name) for name in ("ku_mv", "ki"))


@dataclass(frozen=True)
class _Chosen:
    """Controllers (4, 13), their margins, and the costs (4,) of those from before and of themselves."""

    controllers: Controllers
    margins: tuple[Margin, ...]
    cost_before: Floats
    cost_after: Floats


class DefaultMethod:
    """See the head of this file."""

    def __init__(self, task: TuningRequest) -> None:
        self.task, self.limits = task, task.judging
        self.model = model = give_usual_noise(task.model)
        self.table = model.table
        supply = self.table["supply_mv"]
        period = self.table.period_ms
        whole = Space.default(task.strategy, task.before, supply, period, self.limits.space)
        self.space = whole.with_bounds(task.bounds, period)
        motions = self._motions(task.seed)
        scale = scale_of(motions, model.plants, task.before, task.threads, self.limits)
        some = model.plants[:SEARCH_PLANTS]
        costs: dict[str, Any] = {"limits": self.limits.cost, "swings": self.limits.swings}
        self.objective = Objective(motions, some, scale.first(len(some)), task.threads, **costs)
        other_noise = self._motions(task.seed + JUDGING_SEED)
        self.judging = Objective(other_noise, model.plants, scale, task.threads, **costs)
        # Longer and with other noise, since a search learns its own noise by heart.
        self.judging_margins = self._margins(rest_s=self.limits.margins.long_rest_s, noise=1)
        # With bounds, what is uploaded keeps within them, whatever ran before.
        self.start = self.space.controllers(self.space.points(task.before[None]))[0] if task.bounds else task.before
        self.margins = self._margins(searching=True)
        self.margins_before = self.judging_margins.check(self.start)
        self.standard = Standard.of(self.margins_before, self.table.supply_v, self.limits.quiet, self.limits)
        edge_s, training = self.limits.following.abrupt_s, self.limits.training
        self.abrupt = abrupt_moves(model.arm, self.table, model.plants, edge_s, task.seed + JUDGING_SEED, training)
        self._before: dict[bool, FollowingBefore] = {}
        self.found = SearchState.nothing(self.start)

    def _motions(self, seed: int) -> tuple[TrainingMotion, ...]:
        arm, plants, limits = self.model.arm, self.model.plants, self.limits.training
        if self.task.motion is None:
            return training_motions(arm, self.table, plants, seed, limits)
        return (own_motion(self.task.motion, arm, self.table, plants, seed, limits),)

    def _margins(self, **options: Any) -> Margins:
        task, plants = self.task, self.objective.plants
        common: dict[str, Any] = {"threads": task.threads, "seed": task.seed, "judging": self.limits}
        return Margins(self.model.arm, self.table, plants, **common, **options)

    def facts(self) -> dict[str, Any]:
        return {
            "parameters": list(self.table.raw),
            "board": self.table.board.key,
            "plants": _digest(self.model.plants),
            "bounds": {name: list(pair) for name, pair in sorted(self.task.bounds.items())},
        }

    def cost_before(self) -> Costs:
        return self.found.curve[0][1]

    def search(self, journal: TuningJournal) -> None:
        """Try the controllers from before first, then run the stages."""
        task = self.task

        def tick(found: SearchState) -> None:
            what = "replaying the journal" if journal.replaying else "tuning"
            task.report(what, min(1.0, found.evaluations / task.budget), note=f"cost {found.total:.3f}")

        search = LockstepSearch(self.costs, self.found, journal, tick)
        search.try_again("start")
        for number, stage in enumerate(STAGES, 1):
            if number > 1:
                self.margins = self._margins(searching=True, rest_s=self.limits.margins.long_rest_s)
            left = task.budget - self.found.evaluations
            share = left if stage is STAGES[-1] else min(left, round(stage.share * task.budget))
            if number > 1 and share > len(stage.groups):
                search.try_again(stage.name)
                share -= 1
            self._run(search, stage, number, share // len(stage.groups))

    def _run(self, search: LockstepSearch, stage: Stage, number: int, budget: int) -> None:
        """Spend a stage's evaluations of each joint."""
        if budget < 1:
            return
        space = self.space if stage.every_corner else self.space.reduce()
        best = search.found.best
        search.run(
            space,
            stage=stage.name,
            method=METHOD if self.task.method == "default" else self.task.method,
            budget=budget,
            seed=(self.task.seed, number),
            start=best if stage.every_corner else space.restretch(best),
            groups=stage.groups,
            sigma=stage.sigma,
            pack=FULL_PACK if self.task.budget >= SHORT_BUDGET else PACK,
        )

    def costs(self, controllers: Controllers) -> Floats:
        """The search's costs: (n, 4)."""
        restless = penalty(self.margins.unrest(controllers), self.standard.quiet_v, self.limits)
        return self.objective.costs(controllers) + restless

    def following_before(self, exact: bool = False) -> FollowingBefore:
        """The following of the controllers from before, worked out once where it is wanted."""
        if exact not in self._before:
            hunts = hunting_everywhere(self.margins_before)
            self._before[exact] = FollowingBefore.of(self.judging, self.abrupt, self.start, hunts, exact, self.limits)
        return self._before[exact]

    def judge_costs(self, controllers: Controllers, exact: bool = False) -> Floats:
        """Work out the costs (n, 4) on all plants, with other noise; `exact`: in the bench's own arithmetic."""
        found = self.judging.follow(controllers, exact)
        costs = self.judging.costs_of(found)
        unrest = self.judging_margins.unrest(controllers, exact=exact)
        restless, limits = penalty(unrest, self.standard.quiet_v, self.limits), self.limits.choice
        if self.limits.by_the_arm:
            return costs + limits.unrest_weight_on_arm * restless
        kept = (controllers == self.start).all(axis=2)
        before = self.following_before(exact)
        followed = costs + np.where(kept, 0.0, before.price(found, controllers))
        short: Flags = self.standard.falls_short(unrest, kept) | (before.outweighs(costs) & ~kept)
        return followed + restless + limits.unfit_cost * short

    def _contenders(self) -> Controllers:
        """The best few of every joint (k, 4, 13), and the best with less voltage or integral: steadier and quieter."""
        kept, reductions = self.found.contenders(KEPT), self.limits.choice.gain_reductions
        calmer = np.repeat(kept[:1], len(reductions), axis=0)
        for row, (ku, ki) in zip(calmer, reductions, strict=True):
            row[:, KU] = np.round(ku * row[:, KU])
            row[:, KI] = np.round(ki * row[:, KI])
        unchanged = (kept[0] == self.start).all(axis=1)
        calmer[:, unchanged] = self.start[unchanged]
        # Within what is searched: nothing changes where a factor is not searched, or its bounds are narrower.
        return np.concatenate([kept, self.space.controllers(self.space.points(calmer))])

    def _choose(self) -> _Chosen:
        """The combination that is uploaded.

        Single precision chooses, which is 25 times as fast. The bench's own arithmetic has the last word: a joint that
        costs more than before there, or falls short of the standard, is searched again, then gets its next best, and at
        last what it had.
        """
        judge, judge_exactly = CachedJudge(self.judge_costs), CachedJudge(partial(self.judge_costs, exact=True))
        first, contenders = self._choose_first(judge)
        after = first.copy()
        others: dict[int, list[Controllers]] = {}
        while True:
            chosen, refused = self._judge_exactly(after, judge, judge_exactly)
            if not refused.any():
                return chosen
            if not others and not self.limits.by_the_arm:
                contenders = np.concatenate([self._search_again(first, refused), contenders])
            for joint in map(int, np.flatnonzero(refused)):
                if joint not in others:
                    still = np.flatnonzero(contenders[:, joint, KI] == 0)
                    best = next_best(first, contenders, joint, judge, still, self.limits.choice)
                    others[joint] = [*best, self.start[joint]]
                after[joint] = others[joint].pop(0)

    def _choose_first(self, judge: Judge) -> tuple[Controllers, Controllers]:
        """The best combination of all contenders, and those (k, 4, 13).

        A joint that keeps what it had, though its search found something else, is searched again, and one that follows
        some motions less closely than before.
        """
        contenders, limits = self._contenders(), self.limits.choice
        first, _, _ = choose(self.start, contenders, judge, limits)
        missed = (first == self.start).all(axis=1) & (contenders[0] != self.start).any(axis=1)
        if self.limits.by_the_arm:
            return first, contenders
        short = missed | ((self._prices(first) > 0.0) & (first != self.start).any(axis=1))
        if short.any():
            rows = np.where(missed[:, None], contenders[0], first)
            contenders = np.concatenate([self._search_again(rows, short), contenders])
            first, _, _ = choose(self.start, contenders, judge, limits)
        return first, contenders

    def _prices(self, controllers: Controllers) -> Floats:
        """The prices (4,) of what one combination follows less closely than before."""
        rows = controllers[None]
        prices: Floats = self.following_before().price(self.judging.follow(rows), rows)[0]
        return prices

    def _judge_exactly(self, after: Controllers, judge: Judge, judge_exactly: Judge) -> tuple[_Chosen, Flags]:
        """A combination with its margins and costs, and its changed joints (4,) that must not stay as they are."""
        limits = self.limits.choice
        cost_before, cost_after = judge_exactly(np.stack([self.start, after]))
        margins = self.judging_margins.check(after)
        changed = (after != self.start).any(axis=1)
        worse = cost_after > np.where(changed, limits.joint_slack, limits.kept_joint_slack) * cost_before
        if not self.limits.by_the_arm:
            worse |= self.standard.joints_short(margins, ~changed)
        if worse.any() and not (worse & changed).any():
            worse = self._disturbing(after, worse, judge)
        return _Chosen(after, margins, cost_before, cost_after), worse & changed

    def _search_again(self, rows: Controllers, short: Flags) -> Controllers:
        """The best few (k, 4, 13) of a last search for joints that fall `short` (4,) beside the others of `rows`."""

        def costs(controllers: Controllers) -> Floats:
            restless = penalty(self.margins.unrest(controllers), self.standard.quiet_v, self.limits)
            found = self.objective.follow(controllers)
            return self.objective.costs_of(found) + restless + self.following_before().price(found, controllers)

        search = LockstepSearch(costs, SearchState.nothing(rows))
        search.try_again(AGAIN.name)
        stage = replace(AGAIN, groups=(np.flatnonzero(short).tolist(),))
        self._run(search, stage, len(STAGES) + 1, round(stage.share * self.task.budget))
        return search.found.contenders(KEPT)

    def _disturbing(self, after: Controllers, worse: Flags, judge: Judge) -> Flags:
        """Mark the joint whose controller from before would best serve the worse ones, though they keep theirs (4,)."""
        rows = np.repeat(after[None], len(after), axis=0)
        places = np.arange(len(after))
        rows[places, places] = self.start
        costs = judge(rows)[:, worse].sum(axis=1)
        costs[(after == self.start).all(axis=1)] = np.inf
        chosen: Flags = (places == np.argmin(costs)) & np.isfinite(costs)
        return chosen

    def judge(self) -> Judgement:
        task, model = self.task, self.model
        task.report("judging", 0.0)
        chosen = self._choose()
        after = chosen.controllers
        idle = list(unused(model.arm.joints_in_use))
        after[idle] = task.before[idle]  # whatever was tried there made no difference
        task.report("judging", 0.5)
        margins_before = self.judging_margins.check(task.before) if task.bounds else self.margins_before
        task.report("judging", 0.8)
        plant = model.plants[0]
        held_out = judge_held_out(model.arm, self.table, plant, task.before, after, task.threads, self.limits)
        worse = worse_followers(
            held_out,
            (*self.judging.drills, self.abrupt),
            plant,
            task.before,
            after,
            model.arm.joints_in_use,
            task.threads,
            self.limits.following,
        )
        task.report("judging", 1.0)
        return Judgement(
            after=after,
            cost_before=tuple(map(float, chosen.cost_before)),
            cost_after=tuple(map(float, chosen.cost_after)),
            notes=_notes(chosen.margins, self.limits.swings),
            margins_before=margins_before,
            margins=chosen.margins,
            held_out=held_out,
            worse=worse,
        )


def _notes(margins: tuple[Margin, ...], swings: SwingBounds) -> tuple[str, ...]:
    """One sentence for every scenario in which a joint does not come to rest, or does not move smoothly."""
    return tuple(_note(margin, swings) for margin in margins if not margin.holds)


def _note(margin: Margin, swings: SwingBounds) -> str:
    found = []
    if margin.rattle_rad >= swings.rattle_moving_rad:
        found.append(f"rattles by {1e3 * margin.rattle_rad:.1f} mrad")
    if margin.reversals >= swings.limit_cycle_turns:
        found.append(f"turns round {counted(margin.reversals, 'time')} in a rest")
    if margin.chatter_hz > (swings.chatter_moving_hz if margin.scenario == MOVING else swings.chatter_at_rest_hz):
        found.append(f"has a voltage that swings {margin.chatter_hz:.0f} times a second")
    arms = f"{margin.plants_failing} of {counted(margin.plants, 'simulated arm')}"
    return f"joint {margin.joint}, {margin.scenario}: on {arms} it {' and '.join(found) or 'is lost'}"


def _digest(plants: Floats) -> str:
    return hashlib.sha256(np.ascontiguousarray(plants, dtype="<f8").tobytes()).hexdigest()[:16]


def give_usual_noise(model: Model) -> Model:
    """Return the model, with the noise of a usual potentiometer where it states none.

    Without noise the search would choose a Kd that magnifies the noise of a real board.
    """
    return replace(model, arm=with_usual_noise(model.arm))
