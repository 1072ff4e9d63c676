"""Every mistake that the bench can stage and calibrate can see: named by joint, and no motor driven beyond a pulse."""

from __future__ import annotations

import re
from collections.abc import Iterator
from pathlib import Path

import pytest

from greywhale.calibrate.motors import LEASE_MS, SHARES
from greywhale.cli.entry import run
from greywhale.demo import BenchProcess
from greywhale_sim.mistakes import MISTAKES, USUAL, WHERE, Mistake
from tools.bench.hands import SECOND_DEG, Hands, run_calibrate

SECOND = ("--second", ",".join(f"{angle:g}" for angle in SECOND_DEG))
PWM_STEP = 1 / 400
ENDS = {"refused": 1, "mended": 0, "noted": 0}


@pytest.fixture(scope="module")
def bench() -> Iterator[BenchProcess]:
    with BenchProcess("--speed", "max") as started:
        yield started


def described(mistake: Mistake) -> str:
    return mistake.name


@pytest.mark.parametrize("mistake", [one for one in MISTAKES if one.verb == "calibrate"], ids=described)
def test_calibrate_names_it_and_no_motor_gets_more_than_a_pulse(
    bench: BenchProcess, tmp_path: Path, mistake: Mistake
) -> None:
    place = USUAL[mistake.on]
    hands = Hands(bench)
    hands.bring("both", SECOND_DEG * 0.0)
    bench.command("pins")
    bench.command(f"mistake {mistake.name}")
    try:
        done = run_calibrate(hands, tmp_path, *SECOND)
        seen = bench.command("pins")
    finally:
        bench.command("mistake none")
        backup = tmp_path / "before-calibration.toml"
        if backup.exists():
            assert run(["params", "restore", str(backup), "--port", bench.port]) == 0
    assert re.search(mistake.tells(WHERE[mistake.on].index(place)), done.said + done.printed), done.said + done.printed
    assert done.code == ENDS[mistake.ends]
    assert backup.exists() == (done.code == 0), "what is refused is not stored"
    assert max(seen["duties"]) <= SHARES[-1] + PWM_STEP
    assert seen["longest_on_s"] <= LEASE_MS / 1000 + 0.002
