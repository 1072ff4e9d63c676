"""Every mistake that the bench can stage and calibrate can see: named by joint, and no motor driven beyond a pulse."""

from __future__ import annotations

import re
from pathlib import Path

import pytest

from greywhale.board.calibrate.motors import LEASE_MS
from greywhale.board.calibrate.rules import PULSE_SHARES
from greywhale.board.device import Device
from greywhale.cli.entry import run
from greywhale.cli.story import RunningBench
from greywhale_sim.faults import FAULTS, USUAL, WHERE, Fault
from tools.support.calibrating_person import SECOND_DEG, quick_person, run_calibrate

pytestmark = pytest.mark.slow
SECOND = ("--second", ",".join(f"{angle:g}" for angle in SECOND_DEG))
PWM_STEP = 1 / 400
TRIED = {"pot": "1", "motor": "1", "arm": "0"}  # where it is
BESIDE_ANOTHER = ("pot-swapped", "motor-swapped", "motor-weak")  # only so does it show
ENDS = {"refused": 1, "mended": 0, "noted": 0}


@pytest.mark.parametrize("fault", [one for one in FAULTS if one.verb == "calibrate"], ids=lambda one: one.name)
def test_calibrate_names_it_and_no_motor_gets_more_than_a_pulse(
    bench: RunningBench, tmp_path: Path, fault: Fault
) -> None:
    place, tried = USUAL[fault.on], "1,2" if fault.name in BESIDE_ANOTHER else TRIED[fault.on]
    person = quick_person(bench)
    person.bring("both", SECOND_DEG * 0.0, 0.3)
    with Device(bench.port, restart=False) as device:
        before = device.hello.param_crc
    writes = bench.command("status")["eeprom_writes"]
    bench.command("pins")
    bench.command(f"mistake {fault.name}")
    try:
        done = run_calibrate(person, tmp_path, *SECOND, "--joints", tried)
        seen = bench.command("pins")
        if done.code != 0:
            assert bench.command("status")["eeprom_writes"] == writes, "what is refused is not stored"
            with Device(bench.port, restart=False) as device:
                assert device.hello.param_crc == before, "and what ran before runs again, also without a restart"
    finally:
        bench.command("mistake none")
        backup = tmp_path / "before-calibration.toml"
        if backup.exists():
            assert run(["params", "restore", str(backup), "--port", bench.port]) == 0
    assert re.search(fault.tells(WHERE[fault.on].index(place)), done.said + done.printed), done.said + done.printed
    assert done.code == ENDS[fault.ends]
    assert backup.exists() == (done.code == 0)
    assert max(seen["duties"]) <= PULSE_SHARES[-1] + PWM_STEP
    assert seen["longest_on_s"] <= LEASE_MS / 1000 + 0.002
