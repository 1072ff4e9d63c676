"""The whole way: the compiled firmware on the simulated board drives the default arm, the log is identified."""

from __future__ import annotations

from pathlib import Path

import pytest

from greywhale.arm import ArmParameters
from greywhale.files.leader import save_leader
from greywhale.files.log import Log, LogWriter, read_log
from greywhale.files.log.layout import Origin
from greywhale.identify import identify
from greywhale.protocol import schema
from greywhale.trajectory import human_reaches
from greywhale_sim.assemble import BenchOptions, build_bench
from tests.end_to_end.conftest import LockStep

RAD, VOLT = schema.Sample.LSB["leader"], schema.Sample.LSB["voltage"]
SECONDS = 9.0


def record(folder: Path, seed: int) -> Log:
    """As `greywhale record` does, but without a wall clock."""
    leader, path = folder / f"leader_{seed}.csv", folder / f"log_{seed}.csv"
    save_leader(leader, human_reaches(seed, SECONDS))
    host = LockStep(build_bench(BenchOptions(leader=leader, seed=seed)))
    hello = host.boot()
    host.follow()
    host.ask(schema.TelemetryRequest(1))
    host.samples.clear()
    host.run(SECONDS)
    samples = list(host.samples)
    with LogWriter(path, Origin("0.1.0", "mega2560", hello.param_crc, 1, 1)) as log:
        for sample in samples:
            log.append(
                (sample.tick - samples[0].tick) / 1000,
                [value * RAD for value in sample.leader],
                [value * RAD for value in sample.follower],
                [value * VOLT for value in sample.voltage],
                sample.state.key,
            )
    return read_log(path)


@pytest.mark.slow
def test_logs_of_the_real_firmware_give_the_default_arm(
    tmp_path_factory: pytest.TempPathFactory, white_box: ArmParameters
) -> None:
    folder = tmp_path_factory.mktemp("bench")
    fit, second = record(folder, 13), record(folder, 15)
    assert len(fit.time) > 0.99 * SECONDS * 1000
    assert set(fit.state) == set(second.state) == {"following"}
    outcome = identify([fit], white_box, validate=[second])
    assert outcome.verdicts[1].measure == "closed loop"
    assert outcome.verdicts[1].improvement > 0.9
