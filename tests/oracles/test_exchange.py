"""Exported logs in the hands of others: MCAP in @mcap/core and protobufjs, MAT-files in Octave, Parquet in DuckDB."""

from __future__ import annotations

import json
import os
import shutil
import subprocess
from pathlib import Path

import duckdb
import numpy as np
import pytest

from greywhale.files.exchange.formats import write
from greywhale.files.exchange.recording import ExportOptions, Recording
from tests.files.exchange.example import example
from tools import ROOT

READER = Path(__file__).parent / "mcap" / "read.js"
NODE = {**os.environ, "NODE_PATH": str(ROOT / "build/mcap/node_modules")}
OCTAVE = """
log = load('{file}'); out = fopen('{out}', 'wb');
fwrite(out, [log.t log.y log.u log.leader], 'double'); fclose(out);
printf('%s\\n', jsonencode({{size(log.y), log.Ts, log.names, log.units, log.states(log.state), log.facts}}));
"""


@pytest.fixture(scope="module")
def recording(tmp_path_factory: pytest.TempPathFactory) -> Recording:
    return example(tmp_path_factory.mktemp("log") / "log.csv")


def exported(recording: Recording, name: str, folder: Path) -> Path:
    (out,) = write(name, [recording], folder / f"log.{name}", ExportOptions())
    return out


def test_mcap_core_reads_every_sample_and_fact(recording: Recording, tmp_path: Path) -> None:
    file = exported(recording, "mcap", tmp_path)
    done = subprocess.run(["node", READER, file], env=NODE, check=True, capture_output=True, text=True, timeout=120)
    found = json.loads(done.stdout)
    assert (found["topics"], found["schemas"]) == (["/arm"], ["greywhale.Sample"])
    assert [int(time) for time in found["times"]] == np.round(recording.log.time * 1e9).astype(int).tolist()
    for name, column in ((column.name, column[:]) for column in recording.columns):
        np.testing.assert_array_equal([sample[name] for sample in found["samples"]], column)
    assert [sample["state"].lower() for sample in found["samples"]] == recording.log.state.tolist()
    assert found["metadata"]["greywhale log"] == recording.log.facts


def test_octave_reads_every_number_and_word(recording: Recording, tmp_path: Path) -> None:
    octave = shutil.which("octave-cli")
    if octave is None:
        raise RuntimeError("octave-cli is missing; `make oracles` installs it.")
    file, log = exported(recording, "mat", tmp_path), recording.log
    script = OCTAVE.format(file=file, out=tmp_path / "out.bin")
    done = subprocess.run(
        [octave, "--quiet", "--no-gui", "--eval", script], check=True, capture_output=True, text=True, timeout=120
    )
    size, period, names, units, states, facts = json.loads(done.stdout)
    numbers = np.fromfile(tmp_path / "out.bin").reshape(len(log.time), -1, order="F")
    np.testing.assert_array_equal(numbers, np.column_stack([log.time, log.follower, log.voltage, log.leader]))
    assert (size, period) == ([len(log.time), 4], 0.001)
    assert names == ["leader", "y", "u", "external_torque"]
    assert units == ["rad", "rad", "V", "N m"]
    assert states == log.state.tolist()
    assert json.loads(facts) == log.facts


def test_duckdb_reads_every_column_and_fact(recording: Recording, tmp_path: Path) -> None:
    file = exported(recording, "parquet", tmp_path)
    held = duckdb.sql(f"select * from read_parquet('{file}')").fetchnumpy()
    assert list(held) == ["time_s", *(column.name for column in recording.columns), "state"]
    np.testing.assert_array_equal(held["time_s"], recording.log.time)
    for name, column in ((column.name, column[:]) for column in recording.columns):
        np.testing.assert_array_equal(held[name], column)
    assert [str(word) for word in held["state"]] == recording.log.state.tolist()
    facts = duckdb.sql(f"select key, value from parquet_kv_metadata('{file}')").fetchall()
    found = {key.decode(): value.decode() for key, value in facts}
    assert {key: found[key] for key in found if key != "ARROW:schema"} == recording.log.facts
