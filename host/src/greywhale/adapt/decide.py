"""The decisions of an adaptation: when to search, what to try, what to keep. No clock, no board, no file.

It is fed with stretches of work, and says what should be computed in the background and which set should run.

    watching, enough seen: a task; its proposal is better by more than its uncertainty: a wish, which comes at a rest
    another set than that from the start runs: every few seconds a fit, since a load that is taken up is not its fault;
        one that does not explain what was measured is not believed
    trying, a gain told from chance: kept, watching with the new set
    trying, worse or restless or nothing told after `max_trial_s`: a wish for the set from before, watching
    a joint's reading contradicts its voltages: nothing is tried or kept; when the next fit says so too, the set from
        the start runs again

Over any half minute the error may exceed what the set from the start would have shown by `max_excess`: a share of
that, or of its usual error where the person hardly moves. It is looked at with every stretch, and a set on trial goes
back at once when it is above `alert_excess`. Only a model that was fitted just now speaks against a set that was kept,
or any above twice `max_excess`. All numbers are in `limits.py`.
"""

from __future__ import annotations

from collections import deque
from collections.abc import Iterable, Sequence
from dataclasses import dataclass, field, replace
from enum import StrEnum

import numpy as np

from greywhale.adapt.foresee import foresee, judged_of
from greywhale.adapt.gain import Ratio, Scale
from greywhale.adapt.limits import ADAPTATION_LIMITS, AdaptationLimits
from greywhale.adapt.live_model import LiveModel
from greywhale.adapt.propose import Proposal, Task
from greywhale.adapt.quiet import Swings, find_excess
from greywhale.adapt.stretch import Stretch
from greywhale.base.types import Controllers
from greywhale.loop.controllers import controllers_of
from greywhale.protocol.table import ParameterTable
from greywhale.tune.model import Model


class Outcome(StrEnum):
    KEPT = "kept"
    WORSE = "worse"
    RESTLESS = "restless"
    INCONCLUSIVE = "untold"


@dataclass(frozen=True)
class Wish:
    """A set that should run. `urgent`: now, wherever the leader is; otherwise at a rest."""

    table: ParameterTable
    why: str
    urgent: bool = False


@dataclass(frozen=True)
class TriedSet:
    """A set that ran on trial: `ratio` is its error as a share of what the one before would have had, which lies within
    `low` to `high` with 98 %.
    """

    rows: Controllers = field(repr=False)
    crc: int
    begun_s: float
    predicted: float
    outcome: Outcome
    why: str
    seconds: float
    ratio: float | None
    low: float | None
    high: float | None


@dataclass
class _Trial:
    proposal: Proposal
    table: ParameterTable
    swings_before: Swings | None
    stretches: list[Stretch] = field(default_factory=list)
    seen: list[float] = field(default_factory=list)  # errors of the judged stretches, in the scale's unit
    expected: list[float] = field(default_factory=list)  # what they would have been with the set from before
    begun: bool = False

    def ratio(self, group_s: int) -> Ratio:
        """The errors seen over those expected; so many neighbouring stretches count as one observation."""
        return Ratio.of(np.array(self.seen), np.array(self.expected), group_s)


class Adaptation:
    """See the head of this file. `table` is what the board runs at the start."""

    def __init__(
        self,
        model: Model,
        table: ParameterTable,
        *,
        budget: int,
        seed: int = 0,
        limits: AdaptationLimits = ADAPTATION_LIMITS,
    ) -> None:
        self.model = model
        self._limits, self._decisions, self._lead_s = limits, limits.decisions, limits.gain.lead_s
        self.start = self.running = self.kept = table
        self.live = LiveModel.of(model.arm, limits)
        self.trials: list[TriedSet] = []
        self.searches = 0
        self.doubt = ""  # why the model proposes nothing now
        self._suspicion = ""  # why the readings of the last fit cannot be true
        self.wish: Wish | None = None
        self._budget, self._seed = budget, seed
        self._own: list[Stretch] = []  # with the kept set
        self._newest: deque[Stretch] = deque(maxlen=limits.decisions.fit_s)  # with any
        self._age = self._age_asked = 0  # stretches since those that the model knows; and since those of the task
        # Each stretch's error, and what it would have been.
        self._last_half: deque[tuple[float, float]] = deque(maxlen=limits.decisions.window_s)
        self._scale: Scale | None = None
        self._missed = 0.0  # by how much the last promise was wrong (a logarithm)
        self._trial: _Trial | None = None
        self._since = 0  # stretches since the last search
        self._thinking = False
        self._asked = table  # the set that the last search wanted to better

    @property
    def standby(self) -> ParameterTable | None:
        """The set that the board should have at hand: what is wished for, or what a bad set gives way to."""
        if self.wish is not None:
            return self.wish.table
        if self._trial is not None:
            return self.kept
        return self.start if self.kept.crc != self.start.crc else None

    @property
    def on_trial(self) -> bool:
        """True where the board runs a set that may go back."""
        return self._trial is not None and self._trial.begun

    @property
    def activity(self) -> str:
        """The present activity, in a clause."""
        if self.on_trial:
            return "trying a set"
        return "watching, a search runs" if self._thinking else "watching"

    # --- what comes in ------------------------------------------------------------------------------------------------

    def take(self, stretch: Stretch) -> None:
        """The arm worked for another second."""
        self._since += 1
        self._age, self._age_asked = self._age + 1, self._age_asked + 1
        self._newest.append(stretch)
        if self._trial is not None and self._trial.begun:
            self._trial.stretches.append(stretch)
            self._look_at_trial(self._trial)
        else:
            self._own = [*self._own, stretch][-self._decisions.keep_s :]
            self._look_at_kept()

    def changed(self) -> None:
        """The board runs the set that was wished for."""
        wish = self.wish
        assert wish is not None
        self.running, self.wish = wish.table, None
        trial = self._trial
        if trial is not None and wish.table is trial.table:
            trial.begun = True
            self._last_half.clear()  # what the set from before gained or lost says nothing about this one
        else:
            self._own = []

    def answer(self, found: Proposal | LiveModel) -> None:
        """The background is done with a search, or with a fit."""
        self._thinking = False
        if isinstance(found, Proposal):
            self._weigh(found)
        elif self.wish is None and self._explains(found):
            self.live, self._age = found, self._age_asked
            if self._trusts(found):
                self._reckon_again()

    def _weigh(self, proposal: Proposal) -> None:
        """Wish for what was found, if that promises enough."""
        if proposal.scale.error <= self._decisions.max_log_misfit:
            self.live, self._scale, self._age = proposal.live, proposal.scale, self._age_asked
        if self.wish is not None or self._asked is not self.kept:
            return
        self._missed *= self._decisions.error_memory
        self.doubt = self._doubt(proposal)
        if not self._trusts(proposal.live):
            self.doubt = self._suspicion
        if self.doubt or np.array_equal(proposal.rows, controllers_of(self.kept)):
            return
        table = self.kept.with_controllers(proposal.rows)
        self._trial = _Trial(proposal, table, self._swings_of(self._own))
        self.wish = Wish(table, f"{_lower(proposal.predicted)} error is predicted")

    def _trusts(self, live: LiveModel) -> bool:
        """True where the readings that a model was fitted to can be true. One fit may be wrong: it holds up whatever is
        tried. A second one in a row is believed, and ends a trial or a kept set: no error speaks for a set then, nor
        did it when the set was kept.
        """
        before, self._suspicion = self._suspicion, live.contradiction
        if before and self._suspicion:
            self.doubt = self._suspicion
            if self._trial is not None:
                self._end(self._trial, Outcome.INCONCLUSIVE, self._suspicion)
            if self.kept.crc != self.start.crc:
                self._give_up_kept(Outcome.INCONCLUSIVE, self._suspicion)
        return not self._suspicion

    def hunted(self, joint: int) -> None:
        """A joint swings so that nobody can overlook it."""
        if self.wish is not None:
            self.wish = replace(self.wish, urgent=self._trial is None)
        elif self._trial is not None and self._trial.begun:
            self._end(self._trial, Outcome.RESTLESS, f"joint {joint} hunted", urgent=True)
        elif self.kept.crc != self.start.crc:
            self._give_up_kept(Outcome.RESTLESS, f"joint {joint} hunted")

    # --- what goes out ------------------------------------------------------------------------------------------------

    def task(self) -> Task | None:
        """Return the background's next task, once; None for nothing."""
        if self._thinking or self.wish is not None:
            return None
        limits = self._decisions
        seen = len(judged_of(self._own, self._lead_s)) >= limits.first_search_s
        if seen and self._since >= limits.between_searches_s and self._works() and self._trial is None:
            self._since, self._asked = 0, self.kept
            self.searches += 1
            return self._ask(self.kept, self._own, self._budget)
        due = self._age_asked >= limits.refit_every_s and len(self._newest) == limits.fit_s
        if self.running.crc != self.start.crc and due:
            return self._ask(self.running, self._newest, 0)
        return None

    def _ask(self, table: ParameterTable, stretches: Iterable[Stretch], budget: int) -> Task:
        self._thinking, self._age_asked = True, 0
        start, seed = controllers_of(self.start), self._seed + self.searches
        return Task(self.model, self.live, table, start, tuple(stretches), budget, seed)

    # --- how it decides -----------------------------------------------------------------------------------------------

    def _explains(self, model: LiveModel) -> bool:
        """True where a fit shows the errors that were measured. One to stretches before and after a load was taken up
        fits two arms, and what it says of any set may be wrong by orders of magnitude.
        """
        chain = (self._own if self._trial is None else self._trial.stretches)[-self._decisions.fit_s :]
        measured = np.array([one.error for one in judged_of(chain, self._lead_s)])
        predicted = foresee(model, self.running, controllers_of(self.running), chain, model.plants[:1])[0]
        if not len(measured):
            return True
        return Scale.of(measured, predicted, self._limits.gain).error <= self._decisions.max_log_misfit

    def _doubt(self, proposal: Proposal) -> str:
        limits = self._decisions
        if proposal.scale.error > limits.max_log_misfit:
            return f"the model misses a joint's error by a factor of {np.exp(proposal.scale.error):.2g}"
        own = limits.model_sigma**2
        deviation = np.sqrt(proposal.spread**2 + proposal.scale.deviation**2 + own + self._missed**2)
        uncertainty = limits.sigmas * deviation
        if np.log(proposal.predicted) + uncertainty > 0.0:
            return f"nothing is predicted better by more than the uncertainty of {100 * uncertainty:.0f} %"
        return ""

    def _look_at_kept(self) -> None:
        if self._scale is None or not self._is_led_up_to(self._own):
            return
        self._note_half_minute(self._scale, self._own)
        if self.kept.crc == self.start.crc or self.wish is not None:
            return
        most = self._decisions.max_excess
        if self._excess(self._scale) > (most if self._is_fresh else 2 * most):
            self._give_up_kept(Outcome.WORSE, "it follows worse than the set from the start would")

    def _look_at_trial(self, trial: _Trial) -> None:
        if self.wish is not None or not self._is_led_up_to(trial.stretches):
            return
        scale, limits = trial.proposal.scale, self._decisions
        seen, by_start = self._note_half_minute(scale, trial.stretches)
        trial.seen.append(seen)
        same = self.kept.crc == self.start.crc
        trial.expected.append(by_start if same else self._expected(scale, self.kept, trial.stretches))
        excess = self._excess(scale)
        if excess > limits.alert_excess:
            return self._end(trial, Outcome.WORSE, f"{100 * excess:.0f} % more error in half a minute", urgent=True)
        swings = self._swings_of(trial.stretches[-limits.trial_swings_s :])
        if swings is not None and trial.swings_before is not None:
            clause = find_excess(swings, trial.swings_before, self.kept.supply_v, self._limits.swings)
            if clause:
                return self._end(trial, Outcome.RESTLESS, clause)
        # Each look is another chance to be wrong: one for every new group.
        told = self._is_fresh and len(trial.seen) % self._limits.gain.group_s == 0
        ratio = trial.ratio(self._limits.gain.group_s)
        low, high = ratio.within(scale.deviation) if told else (0.0, np.inf)
        if high < 1.0 - limits.min_gain and not self._suspicion:
            return self._end(trial, Outcome.KEPT, f"{_lower(ratio.value)} error")
        if low > 1.0:
            return self._end(trial, Outcome.WORSE, "more error")
        if len(trial.stretches) >= limits.max_trial_s:
            why = f"no gain could be told from chance in {limits.max_trial_s} s"
            return self._end(trial, Outcome.INCONCLUSIVE, why)
        return None

    def _note_half_minute(self, scale: Scale, chain: Sequence[Stretch]) -> tuple[float, float]:
        """The last stretch's error, and what it would have been with the set from the start; both are remembered."""
        seen = float(scale.seen(chain[-1].error[None])[0])
        is_start = self.running.crc == self.start.crc
        self._last_half.append((seen, seen if is_start else self._expected(scale, self.start, chain)))
        return self._last_half[-1]

    def _reckon_again(self) -> None:
        """The arm may have changed: what would have been in the last stretches, by the model fitted to them."""
        trial = self._trial
        chain = (self._own if trial is None else trial.stretches)[-self._decisions.fit_s - self._lead_s :]
        scale = self._scale if trial is None else trial.proposal.scale
        if scale is None or not all(one.joined for one in chain[1:]):
            return
        by_start, by_kept = (
            scale.expected(foresee(self.live, one, controllers_of(one), chain, self.live.plants[:1])[0]).tolist()
            for one in (self.start, self.kept)
        )
        for back in range(1, min(len(by_start), len(self._last_half)) + 1):
            self._last_half[-back] = self._last_half[-back][0], by_start[-back]
        if trial is not None:
            count = min(len(by_kept), len(trial.expected))
            trial.expected[len(trial.expected) - count :] = by_kept[len(by_kept) - count :]

    def _excess(self, scale: Scale) -> float:
        """Return the error beyond that with the set from the start, as a share, over the last half minute."""
        if not self._last_half:
            return 0.0
        seen, expected = np.array(self._last_half).sum(axis=0)
        return float((seen - expected) / max(expected, self._decisions.window_s * scale.usual))

    def _expected(self, scale: Scale, table: ParameterTable, chain: Sequence[Stretch]) -> float:
        """The last stretch's error, had another set run; in the scale's unit."""
        rows, plant = controllers_of(table), self.live.plants[:1]
        return float(scale.expected(foresee(self.live, table, rows, chain[-self._decisions.context_s :], plant)[0])[-1])

    def _end(self, trial: _Trial, outcome: Outcome, why: str, urgent: bool = False) -> None:
        ratio = trial.ratio(self._limits.gain.group_s) if trial.seen else None
        low, high = (None, None) if ratio is None else ratio.within(trial.proposal.scale.deviation)
        self.trials.append(
            TriedSet(
                rows=trial.proposal.rows,
                crc=trial.table.crc,
                begun_s=trial.stretches[0].begins_s if trial.stretches else 0.0,
                predicted=trial.proposal.predicted,
                outcome=outcome,
                why=why,
                seconds=float(len(trial.stretches)),
                ratio=None if ratio is None else ratio.value,
                low=low,
                high=high if high is not None and np.isfinite(high) else None,
            )
        )
        if ratio is not None:
            self._missed = float(np.log(max(ratio.value, 1e-3) / trial.proposal.predicted))
        self._trial = None
        if outcome is Outcome.KEPT:
            self.kept = trial.table
            self._own = trial.stretches
        else:
            self.wish = Wish(self.kept, why, urgent)

    def _give_up_kept(self, outcome: Outcome, why: str) -> None:
        """A set that was kept disappoints later: back to the start."""
        last = max(place for place, one in enumerate(self.trials) if one.outcome is Outcome.KEPT)
        self.trials[last] = replace(self.trials[last], outcome=outcome, why=f"{why}, after it had been kept")
        self.kept = self.start
        self._missed = self._decisions.max_log_misfit
        self.wish = Wish(self.start, why, urgent=True)

    def _works(self) -> bool:
        """True where a person is at work."""
        leader = np.concatenate([one.leader for one in self._own])
        return bool(np.ptp(leader, axis=0).max() > self._decisions.work_rad)

    def _is_led_up_to(self, chain: Sequence[Stretch]) -> bool:
        """True where enough joined stretches lie before the last one for a prediction."""
        return len(chain) > self._lead_s and all(one.joined for one in chain[-self._lead_s :])

    @property
    def _is_fresh(self) -> bool:
        """True where the model knows the arm as it was just now."""
        return self._age <= self._decisions.fit_s

    def _swings_of(self, stretches: Sequence[Stretch]) -> Swings | None:
        return Swings.of(stretches, self.kept.supply_v, self._limits)


def _lower(ratio: float) -> str:
    return f"{100 * (1 - ratio):.0f} % less"
