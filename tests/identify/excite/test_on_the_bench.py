"""record --excite and replay through the port of the simulated bench: the firmware is led, its log identified."""

from __future__ import annotations

import json
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from greywhale.board.device import Device
from greywhale.board.record import record_led
from greywhale.cli.entry import run
from greywhale.cli.story import RunningBench
from greywhale.files.arm import default_arm, load_arm
from greywhale.files.leader import load_leader
from greywhale.files.log import read_log
from greywhale.files.model import to_toml
from greywhale.identify import identify
from greywhale.loop import human_reaches, leader_motions
from greywhale.protocol.firmware import JOINTS, STEP_LSB
from greywhale.protocol.schema import State
from greywhale_sim.words import lock_step
from tests.support.interrupts import ctrl_c_at


@pytest.fixture
def bench() -> Iterator[RunningBench]:
    with lock_step() as started:
        yield started


def told(capsys: pytest.CaptureFixture[str], *arguments: str) -> dict[str, Any]:
    assert run([*arguments, "--json"]) == 0
    answer: dict[str, Any] = json.loads(capsys.readouterr().out)
    return answer


@pytest.mark.slow
def test_an_excited_log_identifies_the_arm(
    bench: RunningBench, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    """Motors and their friction already; what a search adds to them, such as backlash, takes ten times as long."""
    out, motion = str(tmp_path / "log.csv"), str(tmp_path / "motion.csv")
    arguments = ("--seconds", "8", "--budget", "10", "--range", "0:-0.8:0.9", "--save-motion", motion)
    answer = told(capsys, "record", "--excite", "-p", bench.port, "-o", out, *arguments)
    assert (answer["dropped"], answer["waits"], answer["slowest_pace"]) == (0, 0, 1.0)
    assert not bench.command("status")["motors_enabled"]
    log = read_log(out)
    assert log.complete
    assert set(log.state) == {"following"}
    planned = load_leader(motion)
    shown = np.array(
        [np.interp(planned.time_s, log.time - delay, log.leader[:, 0]) for delay in np.arange(0, 0.6, 4e-3)]
    )
    assert np.abs(shown - planned.angles[:, 0]).max(axis=1).min() < 0.01, "the board was led along the motion"
    assert log.leader[:, 0].min() >= -0.8 - STEP_LSB
    assert log.leader[:, 0].max() <= 0.9 + STEP_LSB
    assert np.abs(log.leader - log.follower).max() < 0.45

    outcome = identify([log], load_arm("white_box"), report=ctrl_c_at("choosing the model's order"))
    assert outcome.found.order == "Coulomb friction"
    found = {one.name: one.value for one in outcome.estimates}
    arm = default_arm()
    for joint in range(JOINTS):
        motor = arm.actuator(joint)
        for kind, true in (("inertia", motor.inertia), ("damping", motor.damping)):
            value = found[f"joint{joint}.{kind}"]
            assert value == pytest.approx(true / motor.torque_per_volt, rel=0.25), f"joint {joint}: {kind}"
    for joint in (1, 2):
        assert found[f"joint{joint}.alpha"] == pytest.approx(1.0 / arm.actuator(joint).torque_per_volt, rel=0.05)


@pytest.mark.slow
def test_visits_of_a_pose_through_the_port_tell_how_exactly_the_arm_comes_back(
    bench: RunningBench, tmp_path: Path, capsys: pytest.CaptureFixture[str], monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(leader_motions, "POSES", leader_motions.POSES[:1])
    out = str(tmp_path / "log.csv")
    answer = told(capsys, "record", "--poses", "2", "-p", bench.port, "-o", out, "--range", "0:-0.3:0.5")
    assert (answer["visits"], answer["dropped"], answer["waits"]) == (2, 0, 0)
    (log,) = told(capsys, "evaluate", "--repeatability", out, "--arm", "default")["logs"]
    (pose,) = log["poses"]
    assert pose["angles_rad"][0] == pytest.approx(0.1, abs=2 * STEP_LSB)
    assert [one["sides"] for one in pose["tip"]["approaches"]] == [["below"] * 4, ["above"] * 4]
    for joint in map(str, range(JOINTS)):
        below, above = pose["joints"][joint]["approaches"]
        assert (below["visits"], above["visits"]) == (2, 2)
        assert pose["joints"][joint]["variation"] > 5e-3, "friction holds each joint where it first stops"


@pytest.mark.slow
def test_a_line_that_loses_bytes_changes_nothing_of_the_motion(bench: RunningBench, tmp_path: Path) -> None:
    bench.command("line lose 0.001")
    motion = human_reaches(5, 4.0)
    with Device(bench.port) as device:
        recording = record_led(device, tmp_path / "log.csv", motion)
        assert device.status().state is State.DISABLED
    assert recording.dropped > 10
    log = read_log(tmp_path / "log.csv")
    later = motion.time_s[None, :] + np.arange(0.0, 2.0, 4e-3)[:, None]
    shown = np.interp(later, log.time, log.leader[:, 0])
    assert np.abs(shown - motion.angles[:, 0]).max(axis=1).min() < 0.03
    assert np.allclose(log.leader[-1], motion.angles[-1], atol=STEP_LSB)


@pytest.mark.slow
def test_an_arm_far_weaker_than_its_file_is_led_more_slowly_and_without_a_fault(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    """A fifth of the voltage that the board believes in: a motion designed for the whole cannot be followed.

    Friction takes five times as much of that voltage, so a joint at rest with 7 V is not a stalled one.
    """
    arm = default_arm()
    weak = arm.model_copy(update={"drive": arm.drive.model_copy(update={"supply": 3.0})})
    (tmp_path / "weak.toml").write_text(to_toml(weak, {}).replace("[identification]\n", ""), encoding="utf-8")
    with lock_step("--arm", str(tmp_path / "weak.toml")) as bench:
        told(capsys, "params", "set", "stall_volts=12", "-p", bench.port)
        arguments = ("-o", str(tmp_path / "log.csv"), "--seconds", "5", "--budget", "10")
        answer = told(capsys, "record", "--excite", "-p", bench.port, *arguments)
    assert answer["slowest_pace"] < 0.9
    assert answer["duration_s"] > 5.25
    log = read_log(tmp_path / "log.csv")
    assert log.complete
    noise = 4 * STEP_LSB  # of the two readings of the pots that its begin and its end come from
    assert np.allclose(log.leader[-1], log.leader[0], atol=noise), "it came back to where it began"


@pytest.mark.parametrize(
    ("arguments", "words"),
    [
        (("--range", "0:1"), "--range is"),
        (("--every", "9"), "1 to 4"),
        (("--enable",), "leave --enable out"),
        (("--arm", "nowhere.toml"), "nowhere.toml"),
        (("-o", "nowhere/log.csv"), "does not exist"),
    ],
)
def test_what_cannot_work_is_refused_before_a_board_is_asked(
    arguments: tuple[str, ...], words: str, capsys: pytest.CaptureFixture[str]
) -> None:
    assert run(["record", "--excite", "-p", "/dev/nothing", *arguments]) != 0
    sentence = capsys.readouterr().err
    assert words in sentence
    assert "/dev/nothing" not in sentence


@pytest.mark.parametrize("option", [("--arm", "white_box"), ("--seed", "1")])
def test_options_of_the_excitation_are_refused_without_it(
    option: tuple[str, str], capsys: pytest.CaptureFixture[str]
) -> None:
    assert run(["record", "-p", "/dev/nothing", *option]) == 2
    assert f"{option[0]} belongs to --excite" in capsys.readouterr().err
