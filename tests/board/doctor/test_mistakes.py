"""Every mistake that the bench can stage and doctor can see with the motors off: named by potentiometer."""

from __future__ import annotations

import json
import re
from collections.abc import Iterator

import pytest

from greywhale.cli.entry import run
from greywhale.cli.story import RunningBench
from greywhale_sim.faults import FAULTS, USUAL, WHERE, Fault
from greywhale_sim.words import lock_step

EXIT_CODES = {"refused": 1, "noted": 0}


@pytest.fixture(scope="module")
def bench() -> Iterator[RunningBench]:
    with lock_step() as started:
        yield started


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
