"""Tuning as a whole: search, a last judgement in the bench's own arithmetic, margins, and motions held out.

The default method:

1. `shape`: a search a joint (`search.py`) for sets that are the same to both sides of zero, over several plants and all
   training motions, with unrest priced. Joints 0 and 2 take turns with 1 and 3: neighbours disturb each other.
2. `every corner`: a narrow search from there, in which each corner and factor is free.
3. The best few of every joint are judged anew, on all plants in the bench's own arithmetic (`judgement.py`). The
   controller from before the tuning is among them, so that no joint ends worse than it began.

Any other method is one search of all joints together with that optimiser, and then step 3.
"""

from __future__ import annotations

from dataclasses import dataclass, field, replace
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np
import numpy.typing as npt

from greywhale.arm import ArmParameters
from greywhale.errors import BAD_USAGE, UserError
from greywhale.loop.controllers import check_controllers
from greywhale.optimise import METHODS as OPTIMISERS
from greywhale.table import CONTROLLER_COLUMNS
from greywhale.tune import search
from greywhale.tune.held_out import judge_held_out
from greywhale.tune.journal import Journal
from greywhale.tune.judgement import choose
from greywhale.tune.margins import REST_LONG_S, Margin, Margins, loosest, penalty
from greywhale.tune.objective import Objective
from greywhale.tune.outcome import Outcome, curves_of
from greywhale.tune.paper import tune_as_paper
from greywhale.tune.progress import Report, silent
from greywhale.tune.search import Found, lockstep
from greywhale.tune.space import Bounds, Space, check_bounds, check_strategy
from greywhale.tune.training import drills

if TYPE_CHECKING:
    from greywhale.tune.model import Model

Floats = npt.NDArray[np.float64]
Controllers = npt.NDArray[np.int32]

DEFAULT_STRATEGY = "both"
METHODS = ("default", "paper", *OPTIMISERS)
DEFAULT_BUDGET = 3000
# Of the budget, what the second, narrow search gets; its box is that share of the whole around the best so far.
NARROW_SHARE = 0.3
NARROW_BOX = 0.03
SHAPE_METHOD, CORNER_METHOD = "cma-es", "cma-es"  # of the default method's two searches
# Plants that the search tracks on, the estimate among them; the last judgement uses all.
SEARCH_PLANTS = 4
# The last judgement prices unrest so much higher that a joint which does not rest is taken for want of any other only.
DEARER = 3.0
# Shares of the best's Ku that compete with it there: full voltage may shake gears which the search saw at rest.
WEAKER = (0.7, 0.5, 0.35)
KU = CONTROLLER_COLUMNS.index("ku_mv")
NOISE_V = 0.0024  # of a potentiometer of which the model says none: half a step of the board's converter


def check_request(
    *,
    strategy: str = DEFAULT_STRATEGY,
    method: str = "default",
    budget: int | None = None,
    seed: int = 0,
    threads: int = 0,
    bounds: Bounds | None = None,
) -> None:
    """Refuse, with exit code 2, what no model could make right."""
    check_strategy(strategy)
    if method not in METHODS:
        raise UserError(f"there is no method {method!r}; there are {', '.join(METHODS)}.", BAD_USAGE)
    for name, value, least in (("budget", budget, 1), ("seed", seed, 0), ("threads", threads, 0)):
        if value is not None and value < least:
            raise UserError(f"{name} is {value}, but it must be at least {least}.", BAD_USAGE)
    if bounds and method == "paper":
        raise UserError("the paper's method has bounds of its own; leave out others.", BAD_USAGE)
    check_bounds(strategy, bounds or {})


def tune(
    model: Model,
    *,
    strategy: str = DEFAULT_STRATEGY,
    method: str = "default",
    budget: int | None = None,
    seed: int = 0,
    threads: int = 0,
    start: Controllers | None = None,
    bounds: Bounds | None = None,
    journal: Path | None = None,
    resume: bool = False,
    report: Report | None = None,
    floors: bool = True,
) -> Outcome:
    """Tune the four controllers of a model.

    `budget` counts sets of four candidates, each tried on all plants and motions; the first is `start`, the controller
    from before: int32 (4, 12), by default that of the model's table. `journal` is a file that keeps every cost, with
    `resume` to go on from. `threads` (0: all cores) changes no bit. `floors` False saves the held-out motions' floors.
    After an interrupt (KeyboardInterrupt) the best so far comes back at once, with `complete` False and not judged;
    only before anything was evaluated it goes on up. Raises UserError.
    """
    check_request(strategy=strategy, method=method, budget=budget, seed=seed, threads=threads, bounds=bounds)
    before = check_controllers(model.controllers if start is None else start)[0]
    if method == "paper":
        return tune_as_paper(model, strategy, budget, seed, threads, before, journal, resume, report or silent, floors)
    work = _Tuning(
        model=_audible(model),
        strategy=strategy,
        method=method,
        budget=DEFAULT_BUDGET if budget is None else budget,
        seed=seed,
        threads=threads,
        before=before,
        bounds=dict(bounds or {}),
        report=report or silent,
    )
    return replace(work.run(journal, resume, floors), model=model)


@dataclass
class _Tuning:
    model: Model
    strategy: str
    method: str
    budget: int
    seed: int
    threads: int
    before: Controllers
    bounds: dict[str, tuple[float, float]]
    report: Report
    found: Found = field(init=False)

    def __post_init__(self) -> None:
        model = self.model
        supply = model.table["supply_mv"]
        period = model.table.period_ms
        self.space = Space.default(self.strategy, self.before, supply, period).bounded(self.bounds, period)
        motions = drills(model.arm, model.table, model.plants, self.seed)
        self.objective = Objective(motions, model.plants[:SEARCH_PLANTS], self.threads)
        self.judge = Objective(motions, model.plants, self.threads)
        self.margins = self._margins(_spanning(model.plants), searching=True)
        # Longer and with other noise, since a search learns its own by heart.
        self.judging_margins = self._margins(_spanning(model.plants), rest_s=REST_LONG_S, noise=1)
        # With bounds, what is downloaded keeps within them, whatever ran before.
        self.start = self.space.controllers(self.space.points(self.before[None]))[0] if self.bounds else self.before
        self.found = Found.nothing(self.start)

    def _margins(self, plants: Floats, **options: Any) -> Margins:
        return Margins(self.model.arm, self.model.table, plants, threads=self.threads, seed=self.seed, **options)

    def request(self) -> dict[str, Any]:
        """What a journal must agree with."""
        return {
            "model": self.model.name,
            "model_digest": self.model.digest,
            "parameters": list(self.model.table.raw),
            "board": self.model.table.board.key,
            "plants": _digest(self.model.plants),
            "strategy": self.strategy,
            "method": self.method,
            "budget": self.budget,
            "seed": self.seed,
            "before": self.before.tolist(),
            "bounds": {name: list(pair) for name, pair in sorted(self.bounds.items())},
        }

    def run(self, journal: Path | None, resume: bool, floors: bool) -> Outcome:
        with Journal(journal, self.request(), resume) as book:
            try:
                self._search(book)
                return self._judged_outcome(floors)
            except KeyboardInterrupt:
                if not self.found.evaluations:
                    raise
                return self._unjudged_outcome()

    def _search(self, book: Journal) -> None:
        def tick(found: Found) -> None:
            what = "replaying the journal" if book.replaying else "tuning"
            self.report(what, min(1.0, found.evaluations / self.budget), note=f"cost {1e3 * found.total:.1f} mrad")

        common: dict[str, Any] = {"evaluate": self.costs, "found": self.found, "journal": book, "tick": tick}
        search.first(self.start, self.costs, self.found, book)
        left = self.budget - 1
        if self.method != "default":
            self._stage("search", self.space, self.method, left, self.start, 1, **common)
            return
        turn = left // len(search.TURNS)
        narrow = int(NARROW_SHARE * turn)
        common["groups"] = search.TURNS
        shape = self.space.reduced()
        self._stage("shape", shape, SHAPE_METHOD, turn - narrow, shape.restretched(self.start), 1, **common)
        self._stage("every corner", self.space, CORNER_METHOD, narrow, self.found.best, 2, sigma=NARROW_BOX, **common)

    def _stage(
        self, name: str, space: Space, method: str, budget: int, start: Controllers, number: int, **options: Any
    ) -> None:
        if budget > 0:
            lockstep(
                space, stage=name, method=method, budget=budget, starts=start[None], seed=(self.seed, number), **options
            )

    def costs(self, controllers: Controllers) -> Floats:
        """Of the search: (n, 4) in rad."""
        costs: Floats = self.objective.costs(controllers) + penalty(self.margins.unrest(controllers))
        return costs

    def judged(self, controllers: Controllers) -> Floats:
        """The same cost on all plants in the bench's arithmetic."""
        unrest = self.judging_margins.unrest(controllers, single=True)
        costs: Floats = self.judge.costs(controllers, single=True) + DEARER * penalty(unrest)
        return costs

    def _contenders(self) -> Controllers:
        """The best few of every joint (k, 4, 12), and the best with less voltage: a quieter second choice."""
        kept = self.found.contenders(search.KEPT)
        weaker = np.repeat(kept[:1], len(WEAKER), axis=0)
        weaker[:, :, KU] = np.round(weaker[:, :, KU] * np.array(WEAKER)[:, None])
        # Within what is searched: without effect where Ku is not, or its bounds are narrower.
        return np.concatenate([kept, self.space.controllers(self.space.points(weaker))])

    def _judged_outcome(self, floors: bool) -> Outcome:
        self.report("judging", 0.0)
        after, cost_before, cost_after = choose(self.start, self._contenders(), self.judged)
        self.report("judging", 0.5)
        model = self.model
        everywhere = self._margins(np.vstack([model.plants, loosest(model.plants)]), rest_s=REST_LONG_S, noise=2)
        margins_before, margins = everywhere.check(self.before), everywhere.check(after)
        self.report("judging", 0.8)
        held_out = judge_held_out(model.arm, model.table, model.plants[0], self.before, after, self.threads, floors)
        self.report("judging", 1.0)
        return replace(
            self._unjudged_outcome(),
            complete=True,
            after=after,
            cost_before=tuple(map(float, cost_before)),
            cost_after=tuple(map(float, cost_after)),
            margins_before=margins_before,
            margins=margins,
            held_out=held_out,
            notes=_notes(margins),
        )

    def _unjudged_outcome(self) -> Outcome:
        """The best so far by the search's own cost."""
        return Outcome(
            model=self.model,
            table=self.model.table,
            strategy=self.strategy,
            method=self.method,
            seed=self.seed,
            budget=self.budget,
            evaluations=self.found.evaluations,
            complete=False,
            before=self.before,
            after=self.found.best.copy(),
            cost_before=self.found.curve[0][1],
            cost_after=self.found.curve[-1][1],
            curves=curves_of(self.found),
            margins_before=(),
            margins=(),
            held_out=(),
            notes=(
                "interrupted: the best so far by the search's own cost; margins and other motions were not looked at",
            ),
        )


def _notes(margins: tuple[Margin, ...]) -> tuple[str, ...]:
    """A sentence for every scenario in which a joint does not come to rest."""
    return tuple(
        f"joint {margin.joint}, {margin.scenario}: {margin.reversals} reversals in a rest and {margin.chatter_hz:.0f} "
        f"duty swings a second on {margin.plants_failing} of {margin.plants} plants"
        for margin in margins
        if not margin.holds
    )


def _spanning(plants: Floats) -> Floats:
    """The estimate, and with it the loosest gears that the samples show, where they differ."""
    loose = loosest(plants)
    return plants[:1] if np.array_equal(loose, plants[0]) else np.vstack([plants[0], loose])


def _digest(plants: Floats) -> str:
    import hashlib

    return hashlib.sha256(np.ascontiguousarray(plants, dtype="<f8").tobytes()).hexdigest()[:16]


def _audible(model: Model) -> Model:
    """The same model with the noise of an ordinary potentiometer where it says none: silence would invite a Kd that
    magnifies the noise of a real board.
    """
    return replace(model, arm=with_noise(model.arm))


def with_noise(arm: ArmParameters) -> ArmParameters:
    """The same arm with NOISE_V on every potentiometer that has none."""
    banks = {}
    for name in ("leader_pots", "follower_pots"):
        bank = getattr(arm, name)
        pots = tuple(pot if pot.noise > 0.0 else pot.model_copy(update={"noise": NOISE_V}) for pot in bank.joint)
        banks[name] = bank.model_copy(update={"joint": pots})
    return arm.model_copy(update=banks)
