"""The host's own Device on the real firmware of a bench in this process: what is uploaded, recorded, lost and said."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from contextlib import ExitStack
from pathlib import Path

import pytest

from greywhale.board.device import Device
from greywhale.board.upload import upload_controller
from greywhale.protocol import schema
from greywhale.protocol.schema import Fault, State
from greywhale_sim.lockstep import LockStepBench
from greywhale_sim.words import lock_step

TABLES = Path(__file__).resolve().parents[2] / "shared" / "fuzzy_tables"

Start = Callable[..., LockStepBench]


@pytest.fixture
def start(leader_file: Path) -> Iterator[Start]:
    """Starts benches with a short motion of the leader."""
    with ExitStack() as running:
        yield lambda *words: running.enter_context(lock_step("--leader", str(leader_file), *words))


@pytest.mark.slow
def test_uploaded_controllers_survive_a_restart(start: Start, tmp_path: Path) -> None:
    eeprom = ("--eeprom", str(tmp_path / "eeprom.bin"))
    bench = start(*eeprom)
    with Device(bench.port) as device:
        built_in = device.hello.param_crc
        crc = upload_controller(device, TABLES / "table_10.toml").param_crc
        assert crc != built_in
    bench.close()
    with Device(start(*eeprom).port) as device:
        assert device.hello.param_crc == crc
        assert device.hello.param_source is not schema.ParamSource.DEFAULTS


@pytest.mark.slow
def test_noise_on_the_line_delays_but_corrupts_nothing(start: Start) -> None:
    bench = start()
    with Device(bench.port) as device:
        bench.command("line flip 0.002")
        bench.command("line lose 0.002")
        crc = upload_controller(device, TABLES / "table_10.toml").param_crc
        bench.command("line flip 0")
        bench.command("line lose 0")
        status = device.status()
        assert status.frames_bad > 0, "the noise was there"
        assert (status.state, status.fault) == (State.DISABLED, Fault.NONE)
    with Device(bench.port) as device:
        assert device.hello.param_crc == crc
