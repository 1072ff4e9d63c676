"""Foreign recordings become records of one joint: units, signs, time and controllers, on files made up here."""

from __future__ import annotations

import math
from pathlib import Path
from types import SimpleNamespace

import numpy as np
import pytest

from greywhale.arm import Arm, ArmParameters
from greywhale.errors import UserError
from greywhale.files.log import Log
from greywhale.loop import plant_row
from tools.bench import bench_real_data
from tools.studies.one_joint import Runner, fit, pieces_of, plants
from tools.studies.real_data import product, study
from tools.studies.real_data.compare import halves
from tools.studies.real_data.product import arm_of, joint_of, log_of
from tools.studies.real_data.rigs import LEVER_RIG, POT_RIG, SERVO_RIG, read_lever, read_pot, read_servo
from tools.studies.real_data.tables import comparison_table

DEGREE = math.pi / 180


def write(path: Path, **columns: np.ndarray) -> Path:
    rows = zip(*(np.atleast_1d(one) for one in columns.values()), strict=True)
    lines = [",".join(columns), *(",".join(f"{value:.6f}" for value in row) for row in rows)]
    path.write_text("\n".join(lines) + "\n", encoding="utf-8")
    return path


def pot_file(folder: Path, name: str = "pid_step.csv", rows: int = 200) -> Path:
    """An Arduino's program run in degrees and thousandths, as its author wrote it."""
    step, integral, before, slope = 450.0 / 128.0, 124.6, 0.0, 0.0
    signals = []
    for row in range(rows):
        r, y = 90.0, step * (row // 10)
        e = r - y
        integral += 13 * 0.002 * (e + before) / 2
        slope = slope * (2 - 0.002) / (2 + 0.002) + 2 * 0.05 / (2 + 0.002) * (e - before)
        u = min(max(46.3 / 5 * e + integral + slope, -1000.0), 1000.0)
        before = e
        signals.append((0.002 * row, r * DEGREE, y * DEGREE, e, u / 10))
    names = ("time_nominal_s", "reference_rad", "position_rad", "error_deg", "u_percent")
    return write(folder / name, **dict(zip(names, np.array(signals).T, strict=True)))


def servo_file(folder: Path) -> Path:
    time = np.cumsum(np.full(400, 0.0053))
    goal, angle = 0.8 * np.sin(2 * time), 0.5 * np.sin(2 * time - 0.2)
    load = 400 * 4096 / (2 * math.pi) / 256 * (goal - angle)
    return write(folder / "xl330_kp400_sin_sin.csv", time_s=time, leader_0=goal, follower_0=angle, load_raw=load)


def lever_file(folder: Path, name: str) -> Path:
    time = 0.002 * np.arange(600)
    leader, follower = 0.05 * np.sin(9 * time), 0.05 * np.sin(9 * time - 0.05)
    torque = 15 * (leader - follower)
    env = np.full(600, 0.3)
    columns = {"leader_0": leader, "follower_0": follower, "tau_env_Nm": env, "tau_cmd_follower_Nm": torque}
    return write(folder / name, time_s=time, **columns)


def test_the_arduinos_program_is_repeated_from_its_angles(tmp_path: Path) -> None:
    source = read_pot(pot_file(tmp_path))
    volts = source.law.output(source.record.leader, source.record.follower)
    np.testing.assert_allclose(volts, source.record.volts, atol=2e-3)
    assert np.ptp(volts) > 3.0


def test_a_row_lasts_as_long_as_the_serial_port_needs_for_its_line(tmp_path: Path) -> None:
    source = read_pot(pot_file(tmp_path))
    # "90.00 0.00 90.00 958.12", carriage return and line feed: 25 bytes of ten bits at 115,200 baud.
    assert source.record.spacing[5] == pytest.approx(25 * 10 / 115200)
    # The time between rows that fit into 2 ms is 2 ms.
    assert source.record.spacing.min() >= 0.002


def test_the_relays_rows_are_ten_passes_of_2_ms(tmp_path: Path) -> None:
    path = pot_file(tmp_path, "relay_method.csv")
    source = read_pot(path)
    np.testing.assert_allclose(source.record.spacing, 0.02)
    assert source.law.limit == POT_RIG.supply
    assert source.law.hysteresis == pytest.approx(4 * DEGREE)
    assert source.law.steps_per_row == 10


def test_the_servos_register_gain_gives_the_voltage_that_was_logged(tmp_path: Path) -> None:
    source = read_servo(servo_file(tmp_path))
    volts = source.law.output(source.record.leader, source.record.follower)
    np.testing.assert_allclose(volts, source.record.volts, atol=1e-4)
    assert source.record.name == "kp400_sin_sin"


@pytest.mark.parametrize(("name", "load"), [("m2_b_free_motion_500hz.csv", 0.0), ("m2_b_spring_500hz.csv", -0.3)])
def test_only_a_lever_that_touches_something_is_loaded(tmp_path: Path, name: str, load: float) -> None:
    source = read_lever(lever_file(tmp_path, name))
    np.testing.assert_array_equal(source.record.load, load)
    assert source.rig.loaded == (load != 0.0)
    assert source.law.output(np.array([0.1, 0.1]), np.zeros(2))[1] == pytest.approx(LEVER_RIG.supply)


def test_a_file_without_a_column_or_with_words_in_it_is_refused_in_a_sentence(tmp_path: Path) -> None:
    path = write(tmp_path / "xl330_kp200_x.csv", time_s=np.arange(3), leader_0=np.zeros(3))
    with pytest.raises(UserError, match=r"has no column follower_0; it has time_s, leader_0"):
        read_servo(path)
    path.write_text("time_s,leader_0,follower_0,load_raw\n0,0,here,0\n", encoding="utf-8")
    with pytest.raises(UserError, match="holds something that is no number"):
        read_servo(path)
    with pytest.raises(UserError, match="cannot be read"):
        read_servo(tmp_path / "nothing.csv")


def test_a_missing_folder_is_told_with_what_to_do_and_leaves_other_benchmarks_running(
    monkeypatch: pytest.MonkeyPatch, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    monkeypatch.setenv(study.VARIABLE, str(tmp_path / "nowhere"))
    with pytest.raises(UserError, match=r"nowhere is not there.*set GREYWHALE_REAL_DATA to the folder"):
        study.data_folder()
    assert bench_real_data.run() == []
    assert "nowhere is not there" in capsys.readouterr().err


def test_a_pendulum_becomes_a_shoulder_that_hangs_and_weighs_what_is_published(tmp_path: Path) -> None:
    source = read_servo(servo_file(tmp_path))
    log, body = log_of(source), Arm(arm_of(SERVO_RIG)).body
    assert joint_of(SERVO_RIG) == 1
    assert np.ptp(log.follower[:, [0, 2, 3]]) == 0.0
    angle = source.record.follower[250]
    weight = body.bias([0.0, log.follower[250, 1], 0.0, 0.0], [0.0] * 4)[1]
    assert weight == pytest.approx(SERVO_RIG.weight * math.sin(angle), rel=1e-3)
    assert body.mass_matrix([0.0] * 4)[1, 1] == pytest.approx(SERVO_RIG.link_inertia, rel=1e-3)
    motor = arm_of(SERVO_RIG).actuator(1)
    assert 1 / motor.torque_per_volt == pytest.approx(SERVO_RIG.alpha)
    assert motor.damping / motor.torque_per_volt == pytest.approx(SERVO_RIG.damping)
    assert motor.inertia / motor.torque_per_volt == pytest.approx(SERVO_RIG.inertia)


def test_an_identified_shoulder_swings_as_the_one_joint_that_it_is(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    source = read_servo(servo_file(tmp_path))

    def found(logs: list[Log], arm: ArmParameters) -> SimpleNamespace:
        # The white box itself, but for a potentiometer that reads 0 at 0.1 rad.
        return SimpleNamespace(plant=plant_row(arm), zero=np.array([0.0, 0.1, 0.0, 0.0]))

    monkeypatch.setattr(product, "identify", found)
    pieces = pieces_of(source.record, 0, len(source.record.time))
    runner = Runner(source.record, None)
    moved = runner.run(product.identified(source), pieces).angles
    expected = runner.run(plants(SERVO_RIG, {"hanging": np.array([-0.1])}), pieces).angles
    assert np.ptp(expected) > 0.3
    np.testing.assert_allclose(moved, expected, atol=1e-9)


@pytest.mark.slow
def test_models_fitted_to_one_half_are_judged_on_the_other(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(fit, "EXTRAS", ())
    source = read_lever(lever_file(tmp_path, "m2_b_free_motion_500hz.csv"))
    comparison = halves(source)
    (score,) = comparison.scores
    assert comparison.title == score.record == "b_free_motion"
    assert score.range_rad == pytest.approx(0.1, rel=0.05)
    # The follower is the leader, turned and 5 ms late: a lag says all of it, and is judged to.
    assert score.first_order < 0.01
    row = comparison_table([comparison]).splitlines()[-1]
    assert row.startswith("| first half | b_free_motion | 0.10 | ")
