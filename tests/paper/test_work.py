"""The pieces of work, each against what is known otherwise."""

from __future__ import annotations

from fractions import Fraction
from pathlib import Path

import numpy as np
import pytest

from greywhale.arm.plants import plant_row
from greywhale.files.arm import load_arm
from greywhale.fuzzy.exact import Feet, infer
from greywhale.fuzzy.settings import JointSettings
from greywhale.loop import human_reaches, steps
from greywhale_paper.pages.numbers import lower
from greywhale_paper.work import arms, bench, errata, findings, grey_box, motions, readings
from greywhale_paper.work.drawn_arms import draw_arm
from greywhale_paper.work.errata import Law
from greywhale_paper.work.motions import PERIOD_MS, printed
from tests.paper.small import shrink


def test_four_times_the_inertia_changes_the_white_box_and_not_the_grey_one(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(errata, "HOLD_S", 0.2)
    monkeypatch.setattr(errata, "SWING_S", 1.0)
    assert errata.swing(frozenset()) == pytest.approx(0.0, abs=1e-6)
    effect = errata.effect(0, ["E1"])
    assert effect["energy"] > 0.1
    assert effect["white_box"]["angle"] > 0.1
    assert effect["grey_box"]["angle"] < 1e-3


@pytest.mark.slow
def test_the_bench_gives_the_same_log_byte_for_byte(tmp_path: Path) -> None:
    table = bench.board(printed("before_tuning"), PERIOD_MS)
    logs = []
    for name in ("one", "two"):
        log = bench.record(tmp_path, name, human_reaches(3, 0.5), table)
        assert log.complete
        assert (log.name, bench.why_ended(log)) == (f"{name}.csv", "")
        assert set(log.state) == {"following"}
        assert log.origin.param_crc == table.crc
        logs.append((tmp_path / f"{name}.csv").read_bytes())
    assert logs[0] == logs[1]
    bench.record(tmp_path, "three", human_reaches(3, 0.5), table, bench.BENCH_SEED + 1)
    assert (tmp_path / "three.csv").read_bytes() != logs[0]


def test_a_drawn_arm_reaches_the_bench_as_it_was_drawn(tmp_path: Path) -> None:
    assert arms.file_of("sticky_grey_box", tmp_path) == Path("sticky_grey_box")  # a bench knows it by its name
    path = arms.file_of("drawn 2", tmp_path)
    assert (plant_row(load_arm(path)) == plant_row(draw_arm(load_arm("white_box"), 2))).all()


def test_the_floor_lies_below_every_printed_controller(monkeypatch: pytest.MonkeyPatch) -> None:
    shrink(monkeypatch)  # shorter motions
    found, floors = grey_box.print_on_grey_box(0), grey_box.floors(0)
    for strategy in grey_box.STRATEGIES:
        for motion in ("steps", "multi-steps"):
            floor = sum(floors[f"{'mf' if strategy == 'mf' else 'sf'} {motion}"]["mse"])
            assert floor < min(sum(found[strategy][motion][which]["mse"]) for which in ("before", "after"))


def test_a_float_law_moves_the_sticky_arm_as_the_firmwares_does() -> None:
    rows = printed("before_tuning")
    floats = errata.follow("sticky_grey_box", frozenset(), Law.of(rows), (1.0,), 3.0)
    arm = load_arm("sticky_grey_box")
    _, leader, angles = motions.play(
        arm, motions.paper_board(15.0), plant_row(arm), rows[None], steps(1.0, 1.0, 3.0), every=1
    )
    firmware = (leader - angles[0])[-3000:]
    assert errata.total_mse(firmware) == pytest.approx(errata.total_mse(floats), rel=0.03)
    assert np.abs(firmware[-500:]).mean(axis=0) == pytest.approx(np.abs(floats[-500:]).mean(axis=0), abs=0.015)


def test_the_reading_decides_what_table_10_gains(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(readings, "LENGTHS_S", (4.0,))
    monkeypatch.setattr(readings, "SMALL_STEP_S", 0.1)  # of steps only is judged
    monkeypatch.setattr(errata, "HOLD_S", 0.01)
    gains = []
    for law in ("feet at 0, ce(k) = e(k) - e(k-1)", "crisp feet, ce = de/dt"):
        found = readings.judge_reading(0, law, "no friction", PERIOD_MS)
        gains.append(lower(*(found[table]["steps"][0] for table in readings.TABLES)))
    assert gains == pytest.approx([-1.0, 67.0], abs=1.0)


def test_friction_explains_where_table_11_rests(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(findings, "LENGTHS_S", (4.0,))
    none, _, implied = findings.friction(0).values()
    assert max(none["before_tuning"]["steady"][0]) < 0.005
    assert implied["before_tuning"]["steady"][0] == pytest.approx([0.12, 0.21, 0.14, 0.11], abs=0.02)


def test_a_seed_gives_the_same_controllers_again(monkeypatch: pytest.MonkeyPatch) -> None:
    shrink(monkeypatch)
    monkeypatch.setattr(grey_box, "BUDGET", 8)
    first, again, other = (grey_box.tune_on_grey_box(seed, "mf", False) for seed in (1, 1, 2))
    assert first == again
    assert first["controllers"] != other["controllers"]
    assert all(after <= before for before, after in zip(first["cost_before"], first["cost"], strict=True))


def test_crisp_feet_leave_a_part_of_the_plane_without_a_rule() -> None:
    assert max(readings.silent(0)["table_10"]) > 0.2


def test_the_printed_objective_rewards_doing_nothing() -> None:
    found = findings.objective(0)
    cost = found["J"]
    assert cost["doing nothing"]["two-sided"] < cost["before"]["two-sided"]
    assert cost["doing nothing"]["one-sided"] > cost["before"]["one-sided"]
    assert max(found["ku"]) < 1.0


def test_a_reason_does_not_name_the_line(tmp_path: Path) -> None:
    table = bench.board(printed("before_tuning"), PERIOD_MS)
    odd = table.with_raw({"tracking_limit": 2048, "tracking_ms": 10})  # 0.5 rad: a step is beyond it
    log = bench.record(tmp_path, "one", steps(1.0, 0.2, 0.1), odd)
    assert not log.complete
    assert bench.why_ended(log).startswith("the board stopped the motors")
    assert log.ended_by == f"{log.ended_by.split(':')[0]}: {bench.why_ended(log)}"


@pytest.mark.parametrize("table", ["table_9", "table_10"])
@pytest.mark.parametrize(("feet", "crisp"), [(Feet.AT_ZERO, False), (Feet.CRISP, True)])
def test_floats_are_the_exact_law(table: str, feet: Feet, crisp: bool) -> None:
    rows = printed(table)
    law = Law.of(rows, crisp)
    law = Law(law.sets, np.ones((4, 4)), crisp)
    random = np.random.default_rng(3)
    for x, y in random.uniform(-1.0, 1.0, (60, 2)):
        found, silent = law.fuzzy(np.full(4, x), np.full(4, y))
        for joint, row in enumerate(rows):
            sets = JointSettings(*map(int, row)).set_values()
            exact = infer(Fraction(float(x)), Fraction(float(y)), sets, feet)
            assert found[joint] == pytest.approx(float(exact.u), abs=1e-12)
            assert bool(silent[joint]) == exact.no_rule


def test_a_rate_is_the_change_over_the_period() -> None:
    rows = printed("before_tuning")
    plain, rate = Law.of(rows), Law.of(rows, rate=True)
    e, change = np.full(4, 0.1), np.full(4, 0.0004)
    assert rate.fuzzy(e, change)[0] == pytest.approx(plain.fuzzy(e, 50.0 * change)[0])
