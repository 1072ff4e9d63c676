"""Foreign recordings become records of one joint: units, signs, time and controllers, on files made up here."""

from __future__ import annotations

import math
from pathlib import Path

import numpy as np
import pytest

from greywhale.base.errors import UserError
from studies.real_data import study
from studies.real_data.rigs import LEVER_RIG, POT_RIG, read_lever, read_pot, read_servo

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


def test_a_missing_folder_is_told_with_what_to_do(monkeypatch: pytest.MonkeyPatch, tmp_path: Path) -> None:
    monkeypatch.setenv(study.VARIABLE, str(tmp_path / "nowhere"))
    with pytest.raises(UserError, match=r"nowhere is not there.*set GREYWHALE_REAL_DATA to the folder"):
        study.data_folder()
