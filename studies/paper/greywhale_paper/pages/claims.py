"""The first page: each claim of the paper with its figure, ours on each kind of arm, and a verdict."""

from __future__ import annotations

from collections.abc import Mapping, Sequence

import numpy as np

from greywhale.tune.report.tables import PAPER_DELAY
from greywhale_paper.optimisers.significance import Verdict, against_each, fewest
from greywhale_paper.pages import identified, readings
from greywhale_paper.pages.document import Chapter, Entry, Row, Sheet, Status
from greywhale_paper.pages.experiment import changes, columns_of
from greywhale_paper.pages.found import Found
from greywhale_paper.pages.identification import last_improvement
from greywhale_paper.pages.numbers import lower, several
from greywhale_paper.pages.optimisers import SAID, costs_of
from greywhale_paper.pages.printed import (
    FIG_6_FLAT,
    FIG_19_FLAT,
    GREY_BOX_BETTER,
    GREY_BOX_BETTER_FITTED,
    MULTI_STEPS_LOWER,
    STEADY_STATE_LOWER,
    STEPS_LOWER,
)
from greywhale_paper.pages.tuning import last_improvement_of_joint, totals
from greywhale_paper.work.arms import DEFAULT, OTHER_HAND, STICKY
from greywhale_paper.work.motions import PERIOD_MS
from greywhale_paper.work.readings import LENGTHS_S

YES, LIKE, NO = "reproduces", "on an arm like the paper's", "does not"
# A figure counts as reached from this share of the printed one on.
NEAR = 0.9
METHOD, PRINTED = "paper's method", "Table 10"
SEARCHED = {"mf": "sets", "sf": "factors", "both": "both"}
RIVALS = ("gwo", "woa", "pso")
OUTPUT_SETS = "265,113 cycles become 6,069 on the ATmega2560, 311 in the firmware (python -m tools.benchmarks fuzzy)"


def chapter(found: Found) -> Chapter:
    """The claims, and the paragraph that explains most of them."""
    return Chapter(
        "What does and does not reproduce",
        (
            Entry("", "The paper's claims", Status.OURS, (table(found),)),
            Entry("", f"Where the {STEPS_LOWER:g} % comes from", Status.OURS, (readings.where_it_comes_from(),)),
        ),
    )


def table(found: Found) -> Sheet:
    claims = (
        _grey_box(
            found, 0, f"The grey box is {GREY_BOX_BETTER_FITTED:g} % better than the white box", GREY_BOX_BETTER_FITTED
        ),
        _grey_box(found, 1, f"On new data it is {GREY_BOX_BETTER:g} % better", GREY_BOX_BETTER),
        _tuning(found, "steps", "Tuning lowers the error on steps by {:g} %", STEPS_LOWER),
        _tuning(found, "multi-steps", "Tuning lowers that on multi-steps by {:g} %", MULTI_STEPS_LOWER),
        _steady_state(found),
        _delay(found),
        Row("Output sets like singletons save time", (OUTPUT_SETS, "", "the same output: Octave to 2e-15", YES)),
        _convergence(found),
        _sets_alone(found),
        _superior(found),
    )
    return Sheet(
        ("the paper says", "default arm", "arm like the paper's", "elsewhere", "verdict"),
        claims,
        notes=(
            f"Median (lowest to highest) of {found.seeds.split(' (')[0].removeprefix('median of ')}; negative: "
            f"worse. A figure is reached where a median is at least {NEAR:g} of the printed one. {YES}: on both "
            f"arms; no verdict below {fewest()} seeds. The first pack is random, or started with "
            "the white box in it. Whose arm is which: docs/arm.md.",
        ),
    )


def judge(default: bool, sticky: bool, seeds: int, needed: int) -> str:
    if seeds < needed:
        return f"open: {seeds} of {needed} seeds"
    return YES if default and sticky else LIKE if sticky else "on the default arm" if default else NO


def _judge(found: Found, default: bool, sticky: bool) -> str:
    return judge(default, sticky, len(found.request.every_seed), fewest())


def _reached(printed: float, *runs: Sequence[float]) -> bool:
    return any(float(np.median(values)) >= NEAR * printed for values in runs)


def _percent(values: Sequence[float | None]) -> str:
    if all(value is None for value in values):
        return "none to measure"
    return f"{several(values, '.0f')} %"


def _grey_box(found: Found, data_set: int, says: str, printed: float) -> Row:
    cells, holds = {}, {}
    for arm in identified.arms_of(found):
        drawn, started = (identified.gains(found, method, arm, data_set) for method in ("paper", "paper-started"))
        cells[arm] = f"random: {_percent(drawn)}; started: {_percent(started)}"
        holds[arm] = _reached(printed, drawn, started)
    drawn_arms = [
        f"{name} started: {_percent(identified.gains(found, 'paper-started', name, data_set))}"
        for name in found.request.drawn
    ]
    elsewhere = "; ".join([f"like the paper's, another hand: {cells[OTHER_HAND]}", *drawn_arms])
    verdict = _judge(found, holds[DEFAULT], holds[STICKY])
    if verdict in (YES, LIKE) and not holds[OTHER_HAND]:
        verdict += ", with one of two hands"
    return Row(says.format(printed), (cells[DEFAULT], cells[STICKY], elsewhere, verdict))


def _on_both_arms(
    says: str, fell: Mapping[str, Mapping[str, Sequence[float | None]]], elsewhere: str, verdict: str
) -> Row:
    cells = [
        f"method: {_percent(fell[arm][METHOD])}; {PRINTED}: {_percent(fell[arm][PRINTED])}" for arm in (DEFAULT, STICKY)
    ]
    return Row(says, (*cells, elsewhere, verdict))


def _tuning(found: Found, motion: str, says: str, printed: float) -> Row:
    fell = {arm: changes(found, motion, arm) for arm in (DEFAULT, STICKY)}
    holds = [_reached(printed, one[METHOD], one[PRINTED]) for one in fell.values()]
    gains = [
        readings.gain(found, reading, length) if motion == "steps" else readings.multi_step_gain(found, reading)
        for reading in found.request.readings
        for length in (LENGTHS_S if motion == "steps" else LENGTHS_S[:1])
    ]
    reached = sum(gain >= NEAR * printed for gain in gains)
    other = (
        f"{PRINTED}, grey box: {min(gains):.0f} to {max(gains):.0f} %, reached in {reached} of {len(gains)} readings"
    )
    verdict = _judge(found, *holds)
    if verdict == NO and reached:
        verdict = f"{NO}; the printed table in some readings"
    return _on_both_arms(says.format(printed), fell, other, verdict)


def _compare(found: Found, arm: str, measure: str, joints: Sequence[int]) -> dict[str, list[float | None]]:
    """By how many per cent a measure, summed over joints, fell; None where it is not defined."""
    columns = columns_of(found, arm)
    (before,) = columns[f"before, {PERIOD_MS} ms"]

    def total(run: Mapping[str, Mapping[str, Mapping[str, Sequence[float | None]]]]) -> float | None:
        values = [run["steps"]["after"][measure][joint] for joint in joints]
        known = [value for value in values if value is not None]
        return sum(known) if len(known) == len(values) else None

    start = total(before)
    fell: dict[str, list[float | None]] = {}
    for name in (METHOD, PRINTED):
        ends = [total(run) for run in columns[name]]
        fell[name] = [None if start is None or end is None else lower(start, end) for end in ends]
    return fell


def _measured(found: Found, measure: str, joints: Sequence[int], says: str, printed: float, elsewhere: str = "") -> Row:
    fell = {arm: _compare(found, arm, measure, joints) for arm in (DEFAULT, STICKY)}
    holds = [
        _reached(printed, *([value for value in values if value is not None] or [-np.inf] for values in one.values()))
        for one in fell.values()
    ]
    verdict = _judge(found, *holds)
    return _on_both_arms(says.format(printed), fell, elsewhere, verdict)


def _steady_state(found: Found) -> Row:
    others = [_percent(_compare(found, STICKY, "steady", (joint,))[PRINTED]) for joint in (0, 2, 3)]
    elsewhere = f"{PRINTED} on the arm like the paper's, joints 0, 2 and 3: {', '.join(others)}"
    says = "Joint 1's steady-state error falls by {:g} %"
    return _measured(found, "steady", (1,), says, STEADY_STATE_LOWER, elsewhere)


def _delay(found: Found) -> Row:
    printed = lower(*(sum(side) for side in PAPER_DELAY))
    return _measured(found, "onset", range(4), "Delays from onset to onset fall, in sum by {:.0f} %", printed)


def _convergence(found: Found) -> Row:
    flat = [last_improvement(run["identified"]["curve"]) for run in found.paper()]
    sticky = [last_improvement(run["identified"]["curve"]) for run in found.paper(STICKY)]
    joints = [[last_improvement_of_joint(run["curves"][joint]) for run in found.grey_box("mf")] for joint in range(4)]
    inside = [min(found_) <= said <= max(found_) for found_, said in zip(joints, FIG_19_FLAT, strict=True)]
    holds = [min(one) <= FIG_6_FLAT <= max(one) and all(inside) for one in (flat, sticky)]
    return Row(
        f"Searches are flat from iteration {FIG_6_FLAT} of 50 (identification) and "
        f"{', '.join(map(str, FIG_19_FLAT))} of 30 (joints)",
        (
            several(flat, ".0f"),
            several(sticky, ".0f"),
            f"joints: {', '.join(several(one, '.0f') for one in joints)}",
            _judge(found, *holds),
        ),
    )


def _sets_alone(found: Found) -> Row:
    fell = {
        kind: {
            strategy: [
                lower(totals(run[kind], "multi-steps", "before"), totals(run[kind], "multi-steps"))
                for run in found.grey_box(strategy)
            ]
            for strategy in SEARCHED
        }
        for kind in ("motions", "sticky")
    }
    holds = {}
    cells = {}
    for kind, gains in fell.items():
        middle = {strategy: float(np.median(values)) for strategy, values in gains.items()}
        holds[kind] = middle["mf"] > max(middle["sf"], middle["both"])
        cells[kind] = "; ".join(f"{name}: {_percent(gains[key])}" for key, name in SEARCHED.items())
    said = f"with friction, {cells['sticky']}", f"the grey box as printed, {cells['motions']}"
    return Row("Tuning the sets alone is best in simulation (multi-steps)", ("", *said, _judge(found, *holds.values())))


def _superior(found: Found) -> Row:
    names = {"identify": "identification", "sets": "tuning"}
    problems = {said: _of_rivals(costs_of(found, name)) for name, said in names.items()}
    duels = against_each(problems, "gwo-woa")
    shifted = {name: _of_rivals(one["shifted"]) for name, one in found.functions().items()}
    tally = [one.word for duel in against_each(shifted, "gwo-woa").values() for one in duel.values()]
    holds = all(one.word == "lower" for duel in duels.values() for one in duel.values())
    counted = ", ".join(f"{word} {tally.count(word)}" for word in ("lower", "higher", "not told apart"))
    told = [_duel(problem, duel) for problem, duel in duels.items()]
    elsewhere = f"its costs on shifted functions: {counted}, of {len(tally)} pairs (Mann-Whitney, Holm)"
    needed = fewest(sum(map(len, duels.values())))
    judged = judge(holds, holds, len(found.request.every_seed), needed)
    return Row("GWO-WOA is superior to GWO, WOA and PSO", (*told, elsewhere, judged))


def _of_rivals(costs: Mapping[str, Sequence[float]]) -> dict[str, Sequence[float]]:
    return {name: costs[name] for name in ("gwo-woa", *RIVALS) if name in costs}


def _duel(problem: str, duel: Mapping[str, Verdict]) -> str:
    said = [f"{SAID[rival]} {one.word} (p = {one.chance:.2g})" for rival, one in duel.items()]
    return f"{problem}, its cost against {'; '.join(said)}"
