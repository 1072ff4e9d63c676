"""Tuning as a whole: search, a last judgement in the bench's own arithmetic, margins, and motions held out.

The default method:

1. Four searches in lockstep (`search.py`), one a joint, over all plants and training motions, with limit cycles priced.
2. A second, narrow search from the best of the first, in which all neighbours are nearly what they will be.
3. The best few of every joint are judged anew in double precision, and the best of them is taken. The controller from
   before the tuning is always among them, so that no joint can end worse than it began.
"""

from __future__ import annotations

from dataclasses import dataclass, field, replace
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np
import numpy.typing as npt

from greywhale.arm import ArmParameters
from greywhale.errors import BAD_USAGE, UserError
from greywhale.link import schema
from greywhale.optimise import METHODS as OPTIMISERS
from greywhale.simulate.tables import check_controllers
from greywhale.tune import search
from greywhale.tune.held_out import judge_held_out
from greywhale.tune.journal import Journal
from greywhale.tune.margins import REST_LONG_S, Margin, Margins, loosest, penalty
from greywhale.tune.objective import Objective
from greywhale.tune.outcome import Outcome, curves_of
from greywhale.tune.paper import tune_as_paper
from greywhale.tune.progress import Report, silent
from greywhale.tune.search import Found, lockstep
from greywhale.tune.space import JOINTS, Bounds, Space, check_bounds, check_strategy
from greywhale.tune.training import drills

if TYPE_CHECKING:
    from greywhale.tune.model import Model

Floats = npt.NDArray[np.float64]
Controllers = npt.NDArray[np.int32]

DEFAULT_STRATEGY = "both"
METHODS = ("default", "paper", *OPTIMISERS)
DEFAULT_BUDGET = 2400
# Of the budget, what the second, narrow search gets; its box is that share of the whole around the best so far.
NARROW_SHARE = 0.4
NARROW_BOX = 0.08
CHOSEN = "cma-es"  # of the default method
# Plants that the search tracks on, the estimate among them; the last judgement uses all.
SEARCH_PLANTS = 4
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

    `budget` counts sets of four candidates, each tried on all plants and motions. `start` int32 (4, 12) is the
    controller from before (else the one in the model's table). `journal` is a file that keeps every cost, with `resume`
    to go on from. `threads` (0: all cores) changes no bit. After an interrupt (KeyboardInterrupt) the best so far comes
    back with `complete` False; only before anything was evaluated it goes on up. Raises UserError.
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
        supply = model.parameters[schema.PARAMETER_BY_NAME["supply_mv"].index]
        period = model.parameters[schema.PARAMETER_BY_NAME["period_ms"].index]
        self.space = Space.default(self.strategy, self.before, supply, period).bounded(self.bounds)
        motions = drills(model.arm, model.parameters, model.plants, self.seed)
        self.objective = Objective(motions, model.plants[:SEARCH_PLANTS], self.threads)
        self.judge = Objective(motions, model.plants, self.threads)
        self.margins = self._margins(_spanning(model.plants), searching=True)
        self.found = Found.nothing(self.before)

    def _margins(self, plants: Floats, **options: Any) -> Margins:
        return Margins(self.model.arm, self.model.parameters, plants, threads=self.threads, seed=self.seed, **options)

    def request(self) -> dict[str, Any]:
        """What a journal must agree with."""
        return {
            "model": self.model.name,
            "model_digest": self.model.digest,
            "parameters": list(self.model.parameters),
            "plants": _digest(self.model.plants),
            "strategy": self.strategy,
            "method": self.method,
            "budget": self.budget,
            "seed": self.seed,
            "before": self.before.tolist(),
            "bounds": {name: list(pair) for name, pair in sorted(self.bounds.items())},
        }

    def run(self, journal: Path | None, resume: bool, floors: bool) -> Outcome:
        complete = True
        with Journal(journal, self.request(), resume) as book:
            try:
                self._search(book)
            except KeyboardInterrupt:
                if not self.found.evaluations:
                    raise
                complete = False
        return self._outcome(complete, floors)

    def _search(self, book: Journal) -> None:
        common: dict[str, Any] = {"evaluate": self.costs, "found": self.found, "journal": book, "tick": self._tick}
        if self.method != "default":
            lockstep(
                self.space, stage="search", method=self.method, budget=self.budget, seed=(self.seed, 1),
                starts=self.before[None], **common,
            )  # fmt: skip
            return
        shape = self.space.reduced()
        self.found.best = shape.restretched(self.before)
        turns = len(search.TURNS)
        narrow = int(NARROW_SHARE * self.budget / turns)
        lockstep(
            shape, stage="shape", method=CHOSEN, budget=max(1, self.budget // turns - narrow), seed=(self.seed, 1),
            starts=self.found.best[None], groups=search.TURNS, **common,
        )  # fmt: skip
        if narrow:
            lockstep(
                self.space, stage="every corner", method=CHOSEN, budget=narrow, seed=(self.seed, 2),
                starts=self.found.best[None], groups=search.TURNS, sigma=NARROW_BOX, **common,
            )  # fmt: skip

    def _tick(self, found: Found) -> None:
        self.report("tuning", min(1.0, found.evaluations / self.budget), note=f"cost {1e3 * found.total:.1f} mrad")

    def costs(self, controllers: Controllers) -> Floats:
        """Of the search: (n, 4) in rad."""
        costs: Floats = self.objective.costs(controllers) + penalty(self.margins.unrest(controllers))
        return costs

    def judged(self, controllers: Controllers) -> Floats:
        """The same cost on all plants in the bench's arithmetic."""
        unrest = self.margins.unrest(controllers, single=True)
        costs: Floats = self.judge.costs(controllers, single=True) + penalty(unrest)
        return costs

    def _outcome(self, complete: bool, floors: bool) -> Outcome:
        self.report("judging", 0.0)
        after, cost_before, cost_after = self._chosen()
        self.report("judging", 0.4)
        everywhere = self._margins(np.vstack([self.model.plants, loosest(self.model.plants)]), rest_s=REST_LONG_S)
        margins_before, margins = everywhere.check(self.before), everywhere.check(after)
        self.report("judging", 0.7)
        held_out = judge_held_out(
            self.model.arm, self.model.parameters, self.model.plants[0], self.before, after, self.threads, floors
        )
        self.report("judging", 1.0)
        return Outcome(
            model=self.model,
            parameters=self.model.parameters,
            strategy=self.strategy,
            method=self.method,
            seed=self.seed,
            budget=self.budget,
            evaluations=self.found.evaluations,
            complete=complete,
            before=self.before,
            after=after,
            cost_before=cost_before,
            cost_after=cost_after,
            curves=curves_of(self.found),
            margins_before=margins_before,
            margins=margins,
            held_out=held_out,
            notes=self._notes(margins),
        )

    def _chosen(self) -> tuple[Controllers, tuple[float, ...], tuple[float, ...]]:
        """The best of every joint's best few by the last judgement, and the costs before and after."""
        rows = np.concatenate([self.before[None], self.found.contenders(search.KEPT)])
        costs = self.judged(rows)
        mixed = rows[0].copy()
        for joint in range(JOINTS):
            mixed[joint] = rows[int(np.argmin(costs[:, joint])), joint]
        finalists = np.concatenate([rows, mixed[None]])
        final = np.concatenate([costs, self.judged(mixed[None])])
        best = int(np.argmin(final.sum(axis=1)))
        return finalists[best].copy(), tuple(map(float, final[0])), tuple(map(float, final[best]))

    def _notes(self, margins: tuple[Margin, ...]) -> tuple[str, ...]:
        return ()


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
