"""A tuning for people: what changed, what to expect on other motions, and what speaks against it."""

from __future__ import annotations

from greywhale.arm.parameters import JOINT_NAMES
from greywhale.base.telling import Column, Part, Row, Sentences, Table, Telling
from greywhale.measure import more_overshoot
from greywhale.tune.judge.held_out import HeldOut
from greywhale.tune.judge.margins import AT_REST, Margin
from greywhale.tune.limits import TUNING_LIMITS
from greywhale.tune.result import TuningResult

_MEASURES = (
    Column("MSE", "rad²", 18),
    Column("x floor", width=7),
    Column("at rest", "rad", 14),
    Column("delay", "s", 14),
)


def summary(outcome: TuningResult) -> str:
    """The text for people."""
    return Telling(tell(outcome)).text()


def tell(outcome: TuningResult) -> list[Part]:
    """The result for people."""
    how = f"{outcome.method}, strategy {outcome.strategy}, seed {outcome.seed}, {outcome.evaluations:,} evaluations"
    unfinished = "UNFINISHED: interrupted; this is the best so far."
    parts: list[Part] = [] if outcome.complete else [Sentences([unfinished], grave=True)]
    name, period, supply = outcome.model.name, outcome.period_ms, outcome.supply_v
    parts.append(Sentences([f"Tuned for {name} at {period} ms and {supply:g} V: {how}."]))
    if outcome.held_out:
        parts.append(Sentences(["Expected on motions that were not trained on, before -> after:"]))
    parts += [table for one in outcome.held_out for table in _motion(one)]
    if worse := outcome.worse_sentences:
        parts.append(Sentences(worse, grave=True))
    if more := overshooting(outcome):
        parts.append(Sentences(more, grave=True))
    if outcome.margins:
        failing = failing_margins(outcome)
        parts.append(Sentences(failing or _held(outcome), grave=bool(failing)))
        parts.append(Sentences(ripples(outcome), near=True))
    notes = list(outcome.notes)
    if (travel := outcome.model.travel) is not None:
        parts.append(Sentences([f"For the board: {travel.sentence}"]))
        notes += [travel.note] if travel.note else []
    if notes:
        parts.append(Sentences(notes, "Notes", listed=True))
    if outcome.model.doubts:
        parts.append(Sentences(outcome.model.doubts, "Doubts about the model", listed=True, grave=True))
    return parts


def _motion(one: HeldOut) -> list[Table]:
    """A row for each joint: the paper's three measures, and the error as a multiple of the least possible."""
    columns = (Column(one.name, width=17, left=True), *_MEASURES)
    rows = []
    for joint in one.before.joints_in_use:
        before, after = one.before.joints[joint], one.after.joints[joint]
        pairs = (
            *(_pair(before.mse, after.mse, ".1e"), _multiple(one, joint)),
            _pair(before.steady_state_error, after.steady_state_error, ".3f"),
            _pair(before.delay_s, after.delay_s, ".3f"),
        )
        is_worse = after.mse > TUNING_LIMITS.choice.worse_in_report * before.mse
        rows.append(Row((_joint(joint), *pairs), remark="WORSE" if is_worse else ""))
    before_sum, after_sum = float(one.mse_before.sum()), float(one.mse_after.sum())
    change = 100.0 * (after_sum / before_sum - 1.0)
    remark = f"{abs(change):.1f} % {'lower' if change <= 0.0 else 'HIGHER'}"
    rows.append(Row(("all joints", _pair(before_sum, after_sum, ".1e"), _multiple(one, -1)), remark))
    return [Table(columns, rows), *_steps(one)]


def _steps(one: HeldOut) -> list[Table]:
    """A row for each joint that steps: overshoot and settling time."""
    columns = (Column(width=17, left=True), Column("overshoot", "%", 18), Column("settling time", "s", 22))
    rows = []
    for joint in one.before.joints_in_use:
        before, after = one.before.joints[joint], one.after.joints[joint]
        if before.overshoot_percent is not None:
            overshoots = _pair(before.overshoot_percent, after.overshoot_percent, ".1f")
            times = f"{before.settling('.2f') or 'none'} -> {after.settling('.2f') or 'none'}"
            rows.append(Row((_joint(joint), overshoots, times)))
    return [Table(columns, rows, near=True)] if rows else []


def _joint(joint: int) -> str:
    return f"{joint} {JOINT_NAMES[joint]}"


def _pair(before: float | None, after: float | None, form: str) -> str:
    return " -> ".join("none" if value is None else f"{value:{form}}" for value in (before, after))


def _multiple(one: HeldOut, joint: int) -> str:
    """The multiple of the least possible error, or a dash where the supply does not limit it. -1: all joints."""
    multiple = one.multiples[joint]
    return "-" if multiple is None else f"{multiple:.2f}"


def ripples(outcome: TuningResult) -> list[str]:
    """A sentence about the ripple at rest, before and after; none where it was not judged."""
    pairs = [
        (before, after)
        for before, after in zip(outcome.margins_before, outcome.margins, strict=False)
        if after.scenario == AT_REST
    ]
    said = ", ".join(f"joint {now.joint} {was.ripple_v:.2f} -> {now.ripple_v:.2f}" for was, now in pairs)
    return [f"Ripple of the voltage at rest (above 20 Hz), V rms: {said}."] if said else []


def _held(outcome: TuningResult) -> list[str]:
    """Say that all margins hold, and on what."""
    plants = outcome.margins[0].plants
    arms = f"on all {plants} plants" if plants > 1 else "on the model itself"
    scenarios = ", ".join(dict.fromkeys(margin.scenario for margin in outcome.margins))
    return [f"Margins hold {arms}, no joint swings, rattles or chatters: {scenarios}."]


def overshooting(outcome: TuningResult) -> list[str]:
    """A sentence for the joints that overshoot more than before the tuning, if there are any."""
    found = [(one.name, more_overshoot(one.before, one.after)) for one in outcome.held_out]
    said = "; ".join(f"on {name} {more}" for name, more in found if more)
    return [f"MORE OVERSHOOT than before: {said}."] if said else []


def failing_margins(outcome: TuningResult) -> list[str]:
    """A sentence for joints that are not steady, one for those that would not be on a slightly different arm, and one
    for those that were no better before.
    """
    failing = [margin for margin in outcome.margins if not margin.holds]
    different, lost = [one for one in failing if one.scenario != AT_REST], outcome.lost_margins
    groups = {
        "NOT STEADY": [one for one in failing if one.scenario == AT_REST],
        "Margins that do not hold": [one for one in different if one in lost],
        "Margins that did not hold before either": [one for one in different if one not in lost],
    }
    return [f"{title}: {'; '.join(_named(one) for one in some)}." for title, some in groups.items() if some]


def _named(margin: Margin) -> str:
    return f"joint {margin.joint} ({JOINT_NAMES[margin.joint]}), {margin.scenario}"
