"""A Nano's log says which board made it: its last two motors have 255 PWM steps where a Mega has 400."""

from __future__ import annotations

from pathlib import Path

import pytest

from greywhale.cli.entry import run
from greywhale.files.arm import load_arm
from greywhale.files.log import read_log
from greywhale.identify import controllers
from greywhale.identify.closed_loop import Loop
from greywhale.identify.data import prepare
from greywhale.protocol.schema import Board
from greywhale.protocol.table import ParameterTable
from greywhale.simulate import plant_row
from greywhale_sim.words import lock_step


@pytest.mark.slow
def test_the_very_voltages_of_a_nanos_log_come_in_its_steps(tmp_path: Path) -> None:
    """Told by the log alone: 15 V in 255 steps on the last two joints, in 400 on the first two."""
    path = tmp_path / "log.csv"
    with lock_step("--board", "nano") as bench:
        assert run(["record", "--enable", "-p", bench.port, "-o", str(path), "--seconds", "4"]) == 0
    log = read_log(path)
    table = controllers.table_of(log, [])
    assert table == ParameterTable.defaults(Board.NANO328)
    loop = Loop(prepare(log, table["filter_shift"]), table, load_arm("default"))
    assert loop.error(plant_row(load_arm("default"))[None]).sum() < 1e-4, "the true arm in its own loop repeats the log"
