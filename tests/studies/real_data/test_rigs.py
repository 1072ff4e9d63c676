"""Foreign recordings become logs: units, signs and time, on files made up here."""

from __future__ import annotations

import math
from pathlib import Path

import numpy as np
import pytest

from greywhale.base.errors import UserError
from studies.real_data.rigs import LEVER_RIG, SERVO_RIG, read_lever, read_pot, read_servo

DEGREE = math.pi / 180


def write(path: Path, **columns: np.ndarray) -> Path:
    rows = zip(*(np.atleast_1d(one) for one in columns.values()), strict=True)
    lines = [",".join(columns), *(",".join(f"{value:.6f}" for value in row) for row in rows)]
    path.write_text("\n".join(lines) + "\n", encoding="utf-8")
    return path


def pot_file(path: Path) -> Path:
    """The potentiometer goes up a step of the converter every ten rows."""
    angle = 450.0 / 128.0 * (np.arange(200) // 10) * DEGREE
    return write(path, reference_rad=np.full(200, 90.0 * DEGREE), position_rad=angle, u_percent=np.full(200, 95.812))


def test_a_row_lasts_as_long_as_the_serial_port_needs_for_its_line(tmp_path: Path) -> None:
    log = read_pot(pot_file(tmp_path / "pid_step.csv"))
    # "90.00 0.00 90.00 958.12", carriage return and line feed: 25 bytes of ten bits at 115,200 baud.
    assert np.diff(log.time)[5] == pytest.approx(25 * 10 / 115200)
    # The time between rows that fit into 2 ms is 2 ms.
    assert np.diff(log.time).min() >= 0.002
    assert log.voltage[0] == pytest.approx([0.95812 * 12.0, 0.0, 0.0, 0.0])


def test_the_relays_rows_are_ten_passes_of_2_ms(tmp_path: Path) -> None:
    np.testing.assert_allclose(np.diff(read_pot(pot_file(tmp_path / "relay_method.csv")).time), 0.02)


def test_the_pendulum_is_a_shoulder_that_hangs_a_quarter_turn_below_level(tmp_path: Path) -> None:
    columns = {"time_s": np.arange(3), "leader_0": np.full(3, 0.8), "follower_0": np.zeros(3)}
    log = read_servo(write(tmp_path / "xl330_kp400_sin_sin.csv", **columns, load_raw=np.full(3, 885.0)))
    assert log.name == "kp400_sin_sin"
    assert log.follower[0] == pytest.approx([0.0, -math.pi / 2, 0.0, 0.0])
    assert log.leader[0] == pytest.approx([0.0, 0.8 - math.pi / 2, 0.0, 0.0])
    assert log.voltage[0] == pytest.approx([0.0, 7.4, 0.0, 0.0])
    motor, link = SERVO_RIG.arm().joint[1].motor, SERVO_RIG.arm().link[1]
    assert motor.torque_constant * 5.0 / motor.resistance == pytest.approx(0.52), "the data sheet's torque at 5 V"
    assert link.mass * link.centre**2 == pytest.approx(0.49 * 0.1**2)


def test_a_levers_torque_is_its_voltage(tmp_path: Path) -> None:
    columns = {"time_s": np.arange(3), "leader_0": np.ones(3), "follower_0": np.zeros(3)}
    log = read_lever(write(tmp_path / "m2_b_spring_500hz.csv", **columns, tau_cmd_follower_Nm=np.full(3, 0.3)))
    assert (log.name, log.voltage[0, 0], log.leader[0, 0]) == ("b_spring", 0.3, 1.0)
    motor = LEVER_RIG.arm().joint[0].motor
    assert motor.torque_constant / motor.resistance == pytest.approx(1.0), "1 V stands for 1 N m"


def test_a_file_without_a_column_or_with_words_in_it_is_refused_in_a_sentence(tmp_path: Path) -> None:
    path = write(tmp_path / "xl330_kp200_x.csv", time_s=np.arange(3), leader_0=np.zeros(3))
    with pytest.raises(UserError, match=r"has no column follower_0; it has time_s, leader_0"):
        read_servo(path)
    path.write_text("time_s,leader_0,follower_0,load_raw\n0,0,here,0\n", encoding="utf-8")
    with pytest.raises(UserError, match="could not convert string to float: 'here'"):
        read_servo(path)
    with pytest.raises(UserError, match="cannot be read"):
        read_servo(tmp_path / "nothing.csv")
