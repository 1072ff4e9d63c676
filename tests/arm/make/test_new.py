"""`greywhale arm new`: one question after the other, wrong answers asked again, files by their keys, what it lifts."""

from __future__ import annotations

import io
import json
import tomllib
from collections.abc import Callable
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from greywhale.arm import Arm
from greywhale.base.formats.units import (
    DEGREE,
    GRAM,
    MILLIVOLT,
    MM,
    NEWTON_METRE,
    RADIAN,
    RPM,
    SECOND,
    read_number,
    unit_of,
)
from greywhale.cli.entry import run
from greywhale.files.arm import load_arm

MOTOR = """gear_ratio = 131
stall_torque_nm = "18 kg cm"
stall_current_a = 5.0
no_load_rpm = 76
"""
ANSWERS = f"""name = "bench arm"
supply_v = 12
tip_g = 50
[[link]]
length_mm = 80
mass_g = 200
[[link]]
length_mm = "14 cm"
section = "bar"
width_mm = 30
height_mm = 5
mass_g = "aluminium"
parts_g = 120
[[link]]
length_mm = 50
[[link]]
length_mm = 120
[[joint]]
{MOTOR}[[joint]]
min_deg = -60
max_deg = 80
[[joint]]
[[joint]]
stall_torque_nm = 0.4
stall_current_a = 1.2
"""


Ask = Callable[[str], tuple[int, dict[str, Any], Path]]
Say = Callable[..., str]


@pytest.fixture
def ask(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> Ask:
    """Has the verb read answers: its exit code, its facts and where the arm is."""
    answers, out = tmp_path / "answers.toml", tmp_path / "arm.toml"

    def told(text: str) -> tuple[int, dict[str, Any], Path]:
        answers.write_text(text)
        out.unlink(missing_ok=True)
        code = run(["arm", "new", "--json", "--answers", str(answers), "--out", str(out)])
        return code, json.loads(capsys.readouterr().out), out

    return told


@pytest.fixture
def say(tmp_path: Path, capsys: pytest.CaptureFixture[str], monkeypatch: pytest.MonkeyPatch) -> Say:
    """Answers the verb with lines: what it said."""

    def said(*lines: str, code: int = 0) -> str:
        monkeypatch.setattr("sys.stdin", io.StringIO("".join(f"{line}\n" for line in lines)))
        assert run(["arm", "new", "--out", str(tmp_path / "arm.toml")]) == code
        return capsys.readouterr().err

    return said


def test_answers_of_a_file_become_an_arm_that_moves(ask: Ask) -> None:
    code, facts, out = ask(ANSWERS)
    assert code == 0
    arm = load_arm(out)
    assert arm.link[0].mass == pytest.approx(0.2)
    assert arm.link[1].mass == pytest.approx(2700 * 0.03 * 0.005 * 0.14 + 0.12)
    assert arm.joint[1].motor == arm.joint[0].motor, "joint 1 has the motor of joint 0"
    assert arm.actuator(0).torque_per_volt * 12 - arm.joint[0].friction.coulomb == pytest.approx(18 * 0.0980665)
    assert arm.joint[3].motor.gear_ratio == 131, "what joint 3 leaves out is as at joint 2"
    assert np.degrees([arm.joint[1].stops.min, arm.joint[1].stops.max]) == pytest.approx([-60, 80])
    assert "joint[0].rated_v" in facts["left_out"]
    assert "link[2].section" in facts["left_out"]
    body = Arm(arm)
    for _ in range(1000):
        angles = body.step([6.0, 0.0, 0.0, 0.0], 0.001)
    assert 1.0 < angles[0] <= np.pi / 2
    assert np.all(np.isfinite(angles))
    levers = np.cumsum([0.0, arm.link[1].length, arm.link[2].length])
    torque = sum(9.81 * link.mass * (lever + link.centre) for link, lever in zip(arm.link[1:], levers, strict=True))
    torque += 9.81 * 0.05 * (levers[2] + arm.link[3].length)
    assert facts["joints"][1]["gravity_nm"] == pytest.approx(torque, abs=1e-6), "that of the arm stretched out"
    assert facts["joints"][0]["gravity_nm"] == 0.0


@pytest.mark.parametrize(
    ("change", "says"),
    [
        (("no_load_rpm = 76", "no_load_rpm = 900"), "joint[0].no_load_rpm is 900: "),
        (('"14 cm"', '"14 ft"'), "link[1].length_mm is '14 ft': "),
        (("length_mm = 80", "length_mm = 0"), "link[0].length_mm is 0: it must be 5 to 2000 mm"),
        (("length_mm = 80", "length = 80"), "link[0].length answers no question"),
        (('"aluminium"', '"cheese"'), "link[1].mass_g is 'cheese': "),
        (("max_deg = 80", "max_deg = -70"), "joint[1].max_deg is -70: it must be -59 to 360 degrees"),
        (("tip_g = 50", "tip_g = true"), "tip_g is True: that is no number"),
        (("[[joint]]\n[[joint]]", "[[joint]]\n[[joint]]\n[[joint]]"), "joint must be tables [[joint]]"),
        (("supply_v = 12", "supply_v = 12\nlinks = 3"), "links answers no question"),
        (('section = "bar"', 'section = "I"'), "link[1].section is 'I': say one of: tube, bar"),
    ],
)
def test_a_wrong_answer_of_a_file_is_named_by_its_key(ask: Ask, change: tuple[str, str], says: str) -> None:
    assert change[0] in ANSWERS
    code, facts, out = ask(ANSWERS.replace(*change))
    assert code == 2
    assert says in facts["error"]
    assert not out.exists()


def test_a_motor_that_cannot_lift_the_arm_is_warned_of(ask: Ask) -> None:
    _, facts, _ = ask(ANSWERS.replace('"18 kg cm"', "0.3").replace("no_load_rpm = 76", "no_load_rpm = 60"))
    (lifts, *_) = facts["warnings"]
    assert lifts.startswith("joint 1 (shoulder pitch) cannot lift the arm: stretched out it needs ")


def test_an_arm_that_is_heavy_for_its_motors_gets_advice_for_the_board(ask: Ask) -> None:
    _, facts, _ = ask(ANSWERS.replace("tip_g = 50", "tip_g = 200"))
    assert facts["joints"][1]["hold_v"] > 3.2
    assert "params set stall_volts=" in facts["before_it_moves"]


def test_a_person_is_asked_again_with_the_reason(tmp_path: Path, say: Say) -> None:
    out = tmp_path / "arm.toml"
    said = say("my own", "much", "0,5", "70", "6 V", *[""] * 100)
    assert "Not 'much': that is no number." in said
    assert "write a point, not a comma" in said
    assert "Not '70': it must be 1 to 60 V." in said
    assert said.index("motor at standstill") < said.index(f"Write {out}?"), "the summary comes before it writes"
    arm = tomllib.loads(out.read_text())
    assert arm["name"] == "my own"
    assert arm["drive"]["supply"] == 6.0


@pytest.mark.parametrize(
    ("lines", "says"),
    [
        (["desk", "9", "90"], "the input ended in the middle"),
        (["desk", "9", "90", *[""] * 43, "no"], "was not written"),
    ],
)
def test_without_a_yes_only_the_answers_are_kept_and_they_can_be_used(
    tmp_path: Path, say: Say, lines: list[str], says: str
) -> None:
    out, again, kept = (tmp_path / name for name in ("arm.toml", "again.toml", "arm.answers.toml"))
    said = say(*lines, code=1)
    assert says in said
    assert f"`greywhale arm new --answers {kept}`" in said
    assert list(tmp_path.iterdir()) == [kept]
    say("desk", "9", "90", *[""] * 100)
    assert run(["arm", "new", "--answers", str(kept), "--out", str(again)]) == 0
    assert load_arm(again) == load_arm(out)


def test_ctrl_c_keeps_the_answers_beside_earlier_ones(
    tmp_path: Path, capsys: pytest.CaptureFixture[str], monkeypatch: pytest.MonkeyPatch
) -> None:
    class Hand:
        """Says some lines, then presses Ctrl-C."""

        def __init__(self, *lines: str) -> None:
            self._lines = iter(lines)

        def readline(self) -> str:
            for line in self._lines:
                return f"{line}\n"
            raise KeyboardInterrupt

    for name in ("arm.answers.toml", "arm.answers-2.toml"):
        monkeypatch.setattr("sys.stdin", Hand("desk", "9", "90", "bar"))
        assert run(["arm", "new", "--out", str(tmp_path / "arm.toml")]) == 130
        assert f"interrupted. Your 4 answers are in {tmp_path / name}" in capsys.readouterr().err
        kept = tomllib.loads((tmp_path / name).read_text())
        assert kept == {"name": "desk", "supply_v": 9.0, "link": [{"length_mm": 90.0, "section": "bar"}]}
    monkeypatch.setattr("sys.stdin", Hand())
    assert run(["arm", "new", "--out", str(tmp_path / "arm.toml")]) == 130
    assert capsys.readouterr().err.endswith("interrupted.\n"), "who said nothing loses nothing"


def test_back_asks_the_question_before_again(tmp_path: Path, say: Say) -> None:
    said = say("back", "desk", "9", "14 cm", "bar", "back", "back", "15 cm", *[""] * 44, "back", "250", "")
    assert said.count("Its length, mm [80]") == 2
    assert said.count("Link 0, the turret") == 3, "the heading tells which link it is, each time one goes back"
    assert said.count("Write ") == 2, "from the summary too"
    arm = load_arm(tmp_path / "arm.toml")
    assert arm.link[0].length == 0.15
    assert arm.follower_pots.joint[0].track == pytest.approx(np.radians(250.0))


@pytest.mark.parametrize(
    ("text", "unit", "value"),
    [
        ("140", MM, 140.0), ("14 cm", MM, 140.0), (".14m", MM, 140.0), ("1e-1 kg", GRAM, 100.0),
        ("5 kg·cm", NEWTON_METRE, 0.490333), ("5 kg-cm", NEWTON_METRE, 0.490333), ("70 oz in", NEWTON_METRE, 0.494312),
        ("1 N m", NEWTON_METRE, 1.0), ("6.2832 rad/s", RPM, 60.0), ("-1.5708 rad", DEGREE, -90.0),
        ("90°", DEGREE, 90.0), ("12V", MILLIVOLT, 12_000.0), ("12 V", MILLIVOLT, 12_000.0), ("-90deg", RADIAN, -1.5708),
        ("500 ms", SECOND, 0.5), ("3 10-bit counts", unit_of("10-bit counts"), 3.0),
    ],
)  # fmt: skip
def test_units_as_people_write_them(text: str, unit: Any, value: float) -> None:
    assert read_number(text, unit) == pytest.approx(value, rel=1e-4)


def test_an_arm_with_two_joints_is_asked_for_their_motors_alone(ask: Ask) -> None:
    text = ANSWERS.split("[[joint]]\nstall")[0]
    for given in ('"0,1"', "[0, 1]"):
        code, facts, out = ask(f"joints = {given}\n{text}")
        assert code == 0, facts
        arm = load_arm(out)
        assert arm.joints_in_use == (0, 1)
        assert [one["joint"] for one in facts["joints"]] == [0, 1]
        assert not any(name.startswith(("joint[2]", "joint[3]")) for name in facts["left_out"])
        assert arm.link[3].mass > 0.0
    code, facts, _ = ask('joints = "0,4"')
    assert code == 2
    assert "joints is '0,4': give one or more of 0 to 3, each once" in facts["error"]
