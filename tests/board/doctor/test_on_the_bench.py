"""Doctor on a real port: a sound bench is good, each staged trouble or mistake is named, and no motor moves."""

from __future__ import annotations

import json
import re
from collections.abc import Iterable
from pathlib import Path

import pytest

from greywhale.cli.entry import run
from greywhale.cli.story import RunningBench
from greywhale.protocol.table import ParameterTable
from greywhale_sim.faults import FAULTS, USUAL, WHERE, Fault
from greywhale_sim.words import lock_step

SECONDS = "1"


def doctor(bench: RunningBench, capsys: pytest.CaptureFixture[str], *more: str) -> tuple[int, dict[str, str]]:
    """The exit code, and check -> verdict: what it says."""
    code = run(["doctor", "--port", bench.port, "--seconds", SECONDS, "--json", *more])
    told = json.loads(capsys.readouterr().out)
    assert not bench.command("status")["motors_enabled"]
    return code, {one["check"]: f"{one['verdict']}: {one['says']}" for one in told["findings"]}


def test_a_sound_bench_is_good(bench: RunningBench, tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    path = str(tmp_path / "mine.toml")
    assert run(["params", "backup", path, "--port", bench.port]) == 0
    capsys.readouterr()
    code, found = doctor(bench, capsys, "--params", path)
    assert found["parameters"].startswith("good")
    assert code == 0
    noted = {check for check, told in found.items() if not told.startswith("good")}
    known = {"stored set", "calibration", "link"}
    assert noted <= known, "nothing is stored yet, the calibration is as shipped, and this machine may be slow"
    assert "none lost" in found["link"]


def test_open_inputs_of_joints_that_are_not_in_use_are_no_trouble(capsys: pytest.CaptureFixture[str]) -> None:
    idle = [f"{side}{joint}.scale" for side in ("leader", "follower") for joint in (2, 3)]
    with lock_step("--arm", "two_joints") as two:

        def set_scales(values: Iterable[float]) -> None:
            settings = [f"{name}={value:g}" for name, value in zip(idle, values, strict=True)]
            assert run(["params", "set", *settings, "--port", two.port]) == 0
            capsys.readouterr()

        set_scales(ParameterTable.defaults().physical(name) for name in idle)
        code, found = doctor(two, capsys)
        assert code == 1
        assert "These read alike" in found["inputs"]
        set_scales([0.0] * len(idle))
        code, found = doctor(two, capsys)
        assert code == 0
        assert found["joints"].startswith("good: Joints 2 and 3 are not in use")
        assert run(["info", "--port", two.port]) == 0
        assert "not in use: leader potentiometer 2, leader potentiometer 3, follower potentiometer 2" in (
            capsys.readouterr().out
        )


EXIT_CODES = {"refused": 1, "noted": 0}


@pytest.mark.slow
@pytest.mark.parametrize("fault", [one for one in FAULTS if one.verb == "doctor"], ids=lambda one: one.name)
def test_doctor_names_it_and_no_motor_is_driven(
    bench: RunningBench, capsys: pytest.CaptureFixture[str], fault: Fault
) -> None:
    bench.command("hand both 0.1 -0.6 0.7 0.4")  # apart from each other, so that only what touches reads alike
    bench.command("pins")
    bench.command(f"mistake {fault.name}")
    try:
        code = run(["doctor", "--port", bench.port, "--seconds", "0.5", "--json", *fault.options])
    finally:
        bench.command("mistake none")
    said = "\n".join(one["says"] for one in json.loads(capsys.readouterr().out)["findings"])
    assert re.search(fault.tells(WHERE[fault.on].index(USUAL[fault.on])), said), said
    assert code == EXIT_CODES[fault.ends]
    assert bench.command("pins") == {"duties": [0.0] * 4, "longest_on_s": 0.0}


@pytest.mark.parametrize(
    ("command", "undo", "check", "says"),
    [
        ("line lose 0.0005", "line lose 0", "link", "lost"),
        ("estop press", "estop release", "fault", "mergency"),
        ("power off", "power on", "board", "nothing answers"),
    ],
)
def test_a_staged_trouble_is_named(
    bench: RunningBench, capsys: pytest.CaptureFixture[str], command: str, undo: str, check: str, says: str
) -> None:
    bench.command(command)
    try:
        code, found = doctor(bench, capsys)
    finally:
        bench.command(undo)
    assert code == 1
    assert found["port"].startswith("good")
    assert found[check].startswith("bad")
    assert says in found[check]
