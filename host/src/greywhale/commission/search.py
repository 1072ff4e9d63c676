"""The search for a set of controllers on a round's model, along the check, before the arm moves.

The tuning does not know the check and its limits; this search does, and its trials cost no time of the arm. It varies
the scaling factors of the tuned controllers by the tuning's own optimiser. What a trial shows beyond the model corrects
the next search: by lower aims, and by plants that hunt as the arm did. A joint that hunted never gets higher gains
again. A joint costs the root of its error in what a hand leads, as a share of that before, and more

- beyond a share of what the check allows, and where it hunts on a worse arm: looser gears, more loop gain, slower
  potentiometers;
- where it would follow steps hardly better than before, if the model knows the joint's steps, swing between them,
  overshoot in moves, or hiss after them;
- for the tuning's margins, without twice the loop gain and softer teeth, for which the worse arm stands; on plants
  that hunt as the arm did softer teeth count, too.
"""

from __future__ import annotations

from collections.abc import Callable, Iterable, Iterator, Sequence
from dataclasses import dataclass, replace
from functools import partial

import numpy as np

from greywhale.arm import ArmParameters
from greywhale.arm.parameters import with_usual_noise
from greywhale.arm.plants import plant_row
from greywhale.base.types import Controllers, Flags, Floats, NotedProgress
from greywhale.commission.evidence import failing_plants
from greywhale.commission.foresee import Foresight
from greywhale.commission.judge import LEAST_RAD2, LED, RESTLESS, Limits
from greywhale.commission.limits import SearchLimits
from greywhale.commission.measures import Measures, measure
from greywhale.commission.trials import Trial, Trials
from greywhale.fuzzy.settings import GAIN_UNIT
from greywhale.identify import loosen_gears
from greywhale.loop.controllers import controllers_of
from greywhale.loop.led_model import LedModel
from greywhale.protocol.firmware import JOINTS
from greywhale.protocol.joints import unused
from greywhale.protocol.table import CONTROLLER_COLUMNS
from greywhale.tune.default import METHOD
from greywhale.tune.judge.margins import TEETH, TWICE, Margins, penalty
from greywhale.tune.model import Model
from greywhale.tune.search.lockstep import TURNS, LockstepSearch, SearchState
from greywhale.tune.search.space import Space

NONE = np.zeros(JOINTS, dtype=bool)
NO_LIMIT_V = np.full(JOINTS, np.inf)  # of ripple in the margins' rests: the check's is limited
KP, KD, KI, KU, CE_TICKS = (CONTROLLER_COLUMNS.index(name) for name in ("kp", "kd", "ki", "ku_mv", "ce_ticks"))
GAINS = [KP, KD, KI, KU]


@dataclass(frozen=True)
class CheckOnModel:
    """The check, played on a model: it gives the costs of controllers, joint by joint."""

    model: ArmParameters
    arm: LedModel
    trials: Trials
    foresight: Foresight  # it knows the model's plant and a worse one
    margins_on: Callable[[Floats], Margins]  # of plants (n, columns)
    margins: Margins  # on the model and looser gears
    limits: Limits  # of the arm
    aims: Limits  # what a set may show on the model
    led: Floats  # (4,) rad², the model's error before in what a hand leads
    swings: Floats  # (2, 4) rad rms, between steps
    overshoot: Floats  # (4,) % of a step, in the check's moves
    failing: Margins | None = None  # on plants that hunt as the arm did
    most: Controllers | None = None  # (4, 13): no joint gets a higher gain than this

    @classmethod
    def of(cls, model: Model, trials: Trials, foresight: Foresight, seed: int, threads: int) -> CheckOnModel:
        """For the trials to come, after that of the controllers from before."""
        arm, table, before = with_usual_noise(model.arm), trials.table.with_raw(trials.others), trials.before
        wanted, running = trials.judging.search, controllers_of(table)[None]
        plants = np.vstack([plant_row(arm), loosen_gears(arm, wanted.gear_sigmas)])
        judging = trials.judging.tuning
        margins_on = partial(Margins, arm, table, threads=threads, searching=True, seed=seed, judging=judging)
        margins = margins_on(plants)
        led = LedModel(arm, table, before.traces)
        (traces,) = led.run(running, foresight.plant)
        known = measure(traces, trials.check, table.supply_v)
        quiet_v = trials.judging.swings.bounds.quiet_share * table.supply_v
        limits, own = (Limits.of(one, NONE, quiet_v, trials.judging) for one in (before.measured, known))
        return cls(
            model=arm,
            arm=led,
            trials=trials,
            foresight=foresight,
            margins_on=margins_on,
            margins=margins,
            limits=limits,
            aims=Limits(
                unrest=wanted.unrest_aim * limits.unrest,
                rattle=wanted.rattle_aim * limits.rattle,
                chatter=wanted.unrest_aim * limits.chatter,
                ripple=np.fmax(wanted.before_aim * known.ripple, wanted.host_ripple_share * quiet_v),
                error=wanted.error_aim * own.error,
            ),
            led=known.error[LED].sum(axis=0),
            swings=np.maximum(foresight.unrest, wanted.still_rad),
            overshoot=np.fmax(known.worst("overshoot"), wanted.max_overshoot),
        )

    @property
    def wanted(self) -> SearchLimits:
        return self.trials.judging.search

    def corrected(self, trial: Trial) -> CheckOnModel:
        """Return the check with lower aims: the model may show less of what a trial had too much of, by that ratio. All
        plants that hunt as the arm did so far join it, and no joint that hunted may have a higher gain than then.
        """
        (known,) = self._measured(trial.rows[None], self.foresight.plant[0])
        aims: dict[str, Floats] = {}
        surer, least = self.wanted.correction_share, self.wanted.least_aim
        for name in (*RESTLESS, "error"):
            aim, shown = getattr(self.aims, name), getattr(trial.measured, name) / getattr(self.limits, name)
            ratio = np.divide(getattr(known, name), shown, out=np.full_like(shown, np.inf), where=shown > surer)
            aims[name] = np.minimum(aim, np.maximum(surer * ratio, least * aim))
        failing, most = failing_plants(self.model, self.trials), np.full(trial.rows.shape, np.iinfo(np.int32).max)
        for one in self.trials.done[1:]:
            hunted = np.flatnonzero([verdict.hunts for verdict in one.verdicts])
            most[hunted] = np.minimum(most[hunted], one.rows[hunted])
        return replace(
            self,
            aims=Limits(**aims),
            failing=self.margins_on(failing) if len(failing) else None,
            most=most,
        )

    def scores(self, controllers: Controllers) -> Floats:
        """(n, 4): the error that the model shows in what a hand leads, as a share of that before."""
        shown = [one.error[LED].sum(axis=0) for one in self._measured(controllers, self.foresight.plant[0])]
        return np.array(shown) / np.maximum(self.led, LEAST_RAD2)

    def costs(self, controllers: Controllers) -> Floats:
        """(n, 4) of controllers (n, 4, 13)."""
        errors, prices = self._judged(controllers)
        return errors + prices

    def _judged(self, controllers: Controllers) -> tuple[Floats, Floats]:
        """The error in what a hand leads, rms as a share of that before, and what the rest costs, (n, 4) each."""
        prices, wanted = self._price_margins(self.margins, controllers, (TWICE, TEETH)), self.wanted
        if self.failing is not None:
            prices += self._price_margins(self.failing, controllers, (TWICE,))
        ratios, restless = self.foresight.estimate(controllers)
        prices += wanted.price * np.maximum(restless / self.swings[:, None] - 1.0, 0.0).max(axis=0)
        worse = np.maximum(ratios / wanted.before_aim - 1.0, 0.0)
        prices += wanted.steps_price * np.where(self.foresight.believed, worse, 0.0)
        errors = np.empty_like(prices)
        for row, one in enumerate(self._measured(controllers, self.foresight.plant[0])):
            errors[row] = np.sqrt(one.error[LED].sum(axis=0) / np.maximum(self.led, LEAST_RAD2))
            prices[row] += wanted.price * self._beyond(one, (*RESTLESS, "error"))
            overshoot = np.nan_to_num(one.worst("overshoot"))
            prices[row] += wanted.price * np.maximum(overshoot / self.overshoot - 1.0, 0.0)
        for plant in self._unsteady():
            for row, one in enumerate(self._measured(controllers, plant, only_unrest=True)):
                prices[row] += wanted.price * self._beyond(one, ["unrest"])
        return errors, prices

    def _unsteady(self) -> Floats:
        """Plants (n, columns) on which a joint comes to rest less easily."""
        worse = self.foresight.worse
        return worse if self.failing is None else np.vstack([worse, self.failing.plants])

    def _price_margins(self, margins: Margins, controllers: Controllers, left_out: Sequence[str]) -> Floats:
        near = {name: found for name, found in margins.unrest(controllers).items() if name not in left_out}
        return penalty(near, NO_LIMIT_V, self.trials.judging.tuning)

    def _measured(self, controllers: Controllers, plant: Floats, *, only_unrest: bool = False) -> Iterator[Measures]:
        """Measure controllers (n, 4, 13), one after another, in the check on a plant (columns,)."""
        for traces in self.arm.run(controllers, plant[None]):
            yield measure(traces, self.trials.check, self.trials.table.supply_v, only_unrest=only_unrest)

    def _beyond(self, measured: Measures, names: Iterable[str]) -> Floats:
        """By what share each joint is beyond what the model may show of these measures, together: (4,)."""
        beyond: Floats = np.zeros(JOINTS)
        for name in names:
            share = np.nan_to_num(getattr(measured, name) / getattr(self.aims, name)).max(axis=0)
            beyond += np.maximum(share - 1.0, 0.0)
        return beyond

    def search(self, begin: Controllers, vary: Flags, seed: int, report: NotedProgress) -> Controllers:
        """The best found around controllers (4, 13), all joints together but for those that `vary` (4,) leaves out."""
        before = controllers_of(self.trials.table)
        best = self._search_around(begin, vary, seed, report)
        poor = vary & (self._judged(best[None])[0][0] > self.wanted.retry_error)
        if poor.any():
            again = best.copy()
            again[poor] = _with_sets_of(before, begin, self.wanted.least_ki)[poor]
            best = self._best_together(best, self._search_around(again, vary, seed, report, "searching once more"))
        idle = list(unused(self.trials.table.joints_in_use))
        best[idle] = before[idle]
        return best

    def _search_around(
        self, begin: Controllers, vary: Flags, seed: int, report: NotedProgress, what: str = "searching on the model"
    ) -> Controllers:
        table, limits = self.trials.table, self.trials.judging.tuning.space
        whole = sum(sets for _, sets in self.wanted.packs)

        def allowed(controllers: Controllers) -> Controllers:
            rows = controllers.copy()
            if self.most is not None:
                rows[..., GAINS] = np.minimum(rows[..., GAINS], self.most[:, GAINS])
            return np.where(vary[:, None], rows, begin)

        def costs(controllers: Controllers) -> Floats:
            return self.costs(allowed(controllers))

        best, found = allowed(begin), SearchState.nothing(begin)
        search = LockstepSearch(costs, found, tick=lambda now: report(what, min(1.0, now.evaluations / whole)))
        for number, (sigma, sets) in enumerate(self.wanted.packs):
            if number:
                search.try_again("check")
            search.run(
                Space.default("sf", found.best, table["supply_mv"], table.period_ms, limits),
                stage="check",
                method=METHOD,
                budget=sets // len(TURNS),
                seed=(seed, number),
                start=found.best,
                groups=TURNS,
                sigma=sigma,
            )
            best = self._best_together(best, allowed(found.best))
        return best

    def _best_together(self, known: Controllers, new: Controllers) -> Controllers:
        """The better of two sets, or one of them with a joint of the other. Each joint's best was found beside other
        neighbours than those it has in the end.
        """
        sets = [known, new]
        for joint in range(JOINTS):
            for whole, part in ((known, new), (new, known)):
                mixed = whole.copy()
                mixed[joint] = part[joint]
                sets.append(mixed)
        return sets[int(np.argmin(self.costs(np.stack(sets)).sum(axis=1)))].copy()


def _with_sets_of(before: Controllers, tuned: Controllers, least_ki: float) -> Controllers:
    """The controllers from before with the voltage and the derivative of the tuned ones, and some integral part."""
    rows = before.copy()
    rows[:, [KU, CE_TICKS]] = tuned[:, [KU, CE_TICKS]]
    rows[:, KI] = np.maximum(rows[:, KI], least_ki * GAIN_UNIT)
    return rows
