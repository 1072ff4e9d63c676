"""The benchmarks of the tuning say "holds" when it does, and only then."""

from __future__ import annotations

from dataclasses import asdict, replace
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from greywhale.measure import Evaluation, JointMeasures
from greywhale.study import Task, TaskFailed
from greywhale.study.plain import decode, encode
from greywhale.tune.judge.margins import Margin
from tests.study import jobs
from tools.bench import bench_tune_arms, bench_tune_methods, study
from tools.bench.figure import Figure
from tools.bench.tuning import Judged, figures

FLOOR = np.array([0.02, 0.01, 0.01, 0.01])


def evaluation(mse: float = 0.02, steady: float | None = 0.01, delay: float | None = 0.05) -> Evaluation:
    joints = (JointMeasures(mse, steady, delay, delay, 1),) * 4
    return Evaluation(joints, 4 * mse, 1000, 1.0, True, (1.0,) * 4)


def worse(judged: Evaluation, joint: int, **measures: Any) -> Evaluation:
    """The same with one joint's measures replaced; the total stays, so that nothing but the joint tells."""
    joints = list(judged.joints)
    joints[joint] = replace(joints[joint], **measures)
    return replace(judged, joints=tuple(joints))


def missed(name: str, before: Evaluation, after: Evaluation, floor: np.ndarray = FLOOR) -> list[str]:
    found: list[Figure] = figures("arm", {name: Judged(name, before, after, floor)})
    return [one.name for one in found if one.holds is False]


def test_nothing_is_missed_where_every_bar_is_met() -> None:
    assert missed("steps", evaluation(0.02), evaluation(0.0143)) == []
    assert missed("multi-steps", evaluation(0.02), evaluation(0.02)) == []


def test_steps_hold_by_either_bar_alone() -> None:
    before, after = evaluation(0.02), evaluation(0.0145)
    assert missed("steps", before, after) == ["arm, steps: MSE lower by", "arm, steps: MSE over the floor"]
    assert missed("steps", before, after, 1.05 * FLOOR) == []
    assert missed("steps", evaluation(0.067), after) == []


@pytest.mark.parametrize("joint", range(4))
@pytest.mark.parametrize(
    ("measures", "bar"),
    [
        ({"mse": 0.021}, "MSE of the worst joint, after / before"),
        ({"steady_state_error": 0.0201}, "largest steady-state error"),
        ({"delay_s": 0.0515}, "delay, most grown"),
        ({"onset_delay_s": 0.0515}, "onset delay, most grown"),
    ],
)
def test_a_single_joint_misses_a_bar(joint: int, measures: dict[str, float], bar: str) -> None:
    after = worse(evaluation(0.0143), joint, **measures)
    assert missed("multi-steps", evaluation(), after) == [f"arm, multi-steps: {bar}"]


def test_what_a_motion_does_not_define_is_no_figure() -> None:
    quiet = evaluation(0.001, steady=None, delay=None)
    names = [one.name for one in figures("arm", {"reaches": Judged("reaches", quiet, quiet, np.full(4, 1e-6))})]
    assert names == [
        "arm, reaches: total MSE before",
        "arm, reaches: total MSE after",
        "arm, reaches: MSE lower by",
        "arm, reaches: MSE of the worst joint, after / before",
    ]


def test_a_swinging_joint_is_told_from_one_that_settles_or_trembles() -> None:
    time = np.arange(1000) * 1e-3
    swings = 0.02 * np.sin(2 * np.pi * 5 * time)
    settles = 0.05 * np.exp(-time / 0.1)
    trembles = 0.004 * np.sin(2 * np.pi * 20 * time)
    assert bench_tune_arms.reversals(swings) == 10
    assert bench_tune_arms.reversals(settles) == 0
    assert bench_tune_arms.reversals(trembles) == 0
    rest = np.zeros((2500, 4))
    cycling = rest.copy()
    cycling[-1000:, 2] = swings
    assert bench_tune_arms.unrest(np.vstack([rest, rest, rest])) == ()
    assert bench_tune_arms.unrest(np.vstack([rest, cycling, rest])) == (2,)


def test_methods_are_compared_by_arm_and_seed() -> None:
    rival = np.arange(1.0, 21.0)
    assert bench_tune_methods.verdict(0.9 * rival, rival)[0] == "lower"
    assert bench_tune_methods.verdict(1.1 * rival, rival)[0] == "higher"
    mixed = rival * np.where(np.arange(20) % 2, 1.01, 0.99)
    assert bench_tune_methods.verdict(mixed, rival)[0] == "not told apart"
    found = [
        {
            method: rival * factor
            for method, factor in zip(bench_tune_methods.METHODS, (1.1, 1.0, 1.2, 1.3), strict=True)
        }
        for _ in bench_tune_methods.ARMS
    ]
    text = bench_tune_methods.table(found)
    assert text.index("| cma-es | 10.500 (19.000) |") < text.index("| gwo-woa-relative | 11.550 (20.900) |")
    assert "| 2.00 |  |" in text
    assert "| 1.00 | higher, p = " in text
    assert text.count("| lower, p = ") == 2


def test_a_verdict_comes_back_from_the_process_that_judged() -> None:
    """As the fields that a study can carry, numbers bit for bit."""
    four = np.array([0.1, 1 / 3, np.inf, 5e-324])
    margins = (Margin("at rest", 1, 4, 12.5, 2, 8), Margin("while moving", 3, 0, 0.0, 0, 8, 1e-3))
    verdict = bench_tune_arms.Verdict(7, {"steps": four}, {"steps": 0.5 * four}, four, margins, (0, 2))
    back = bench_tune_arms.verdict_of(decode(encode(asdict(verdict))))
    assert asdict(back) | {"before": 0, "after": 0, "floor": 0} == asdict(verdict) | {
        "before": 0,
        "after": 0,
        "floor": 0,
    }
    assert back.failing == [margins[0]]
    for one, other in (
        (back.before, verdict.before),
        (back.after, verdict.after),
        ({"steps": back.floor}, {"steps": four}),
    ):
        assert one["steps"].tobytes() == other["steps"].tobytes()


def test_what_a_benchmark_repeats_goes_on_after_a_break_and_is_measured_anew_when_it_was_done(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(study, "FOLDER", tmp_path)
    monkeypatch.delenv("GREYWHALE_EXECUTOR", raising=False)
    monkeypatch.delenv("GREYWHALE_WORKERS", raising=False)
    stop = tmp_path / "stop"
    stop.touch()
    tasks = [*jobs.notes(2, tmp_path), Task("stopped", jobs.fail_while, 0, {"path": str(stop)})]
    with pytest.raises(TaskFailed):
        study.repeat("squares", tasks)
    assert len(list(tmp_path.glob("squares-*.study"))) == 1
    stop.unlink()
    assert study.repeat("squares", tasks) == {"note 0": 0, "note 1": 1, "stopped": None}
    assert jobs.done(tmp_path) == [0, 1]
    assert not list(tmp_path.glob("*.study"))
    study.repeat("squares", tasks)
    assert jobs.done(tmp_path) == [0, 0, 1, 1]
