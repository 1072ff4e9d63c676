"""Each format of other programs holds a log's numbers, words and facts; their own readers say so."""

from __future__ import annotations

import json
import resource
from collections.abc import Iterator
from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from mcap.reader import make_reader
from mcap_protobuf.decoder import DecoderFactory
from pyarrow import parquet
from scipy.io import loadmat

from greywhale.base.errors import BadUsage, UserError
from greywhale.files.exchange import formats
from greywhale.files.exchange.formats import FORMATS, Format, require_possible, write
from greywhale.files.exchange.recording import ExportOptions, Recording
from greywhale.files.log.layout import STATES
from tests.files.exchange.example import example

NONE = ExportOptions()
UNITS = {"leader": "rad", "follower": "rad", "voltage": "V", "external_torque": "N m"}


@pytest.fixture
def recording(path: Path) -> Recording:
    return example(path)


def test_npz(recording: Recording, tmp_path: Path) -> None:
    out = tmp_path / "log.npz"
    assert write("npz", [recording], out, NONE) == [out]
    held, log = np.load(out), recording.log
    np.testing.assert_array_equal(held["time_s"], log.time)
    for name, values in (("leader", log.leader), ("follower", log.follower), ("voltage", log.voltage)):
        np.testing.assert_array_equal(held[name], values)
    np.testing.assert_array_equal(held["external_torque"], 0.25 * log.voltage)
    np.testing.assert_array_equal(held["states"][held["state"]], log.state)
    assert json.loads(str(held["facts"])) == log.facts
    assert json.loads(str(held["units"])) == {"time_s": "s"} | UNITS


def test_mcap(recording: Recording, tmp_path: Path) -> None:
    """The package mcap reads it, and decodes the messages by the schema in the file."""
    out = tmp_path / "log.mcap"
    assert write("mcap", [recording], out, NONE) == [out]
    log = recording.log
    with open(out, "rb") as file:
        reader = make_reader(file, decoder_factories=[DecoderFactory()])
        found = list(reader.iter_decoded_messages())
        metadata = {one.name: one.metadata for one in reader.iter_metadata()}
    assert {channel.topic for _, channel, _, _ in found} == {"/arm"}
    assert {schema.name for schema, _, _, _ in found if schema} == {"greywhale.Sample"}
    times = [raw.log_time for _, _, raw, _ in found]
    assert times == [raw.publish_time for _, _, raw, _ in found] == np.round(log.time * 1e9).astype(int).tolist()
    assert len(recording.columns) == 16
    for name, column in ((column.name, column[:]) for column in recording.columns):
        np.testing.assert_array_equal([getattr(sample, name) for *_, sample in found], column)
    assert [STATES[sample.state] for *_, sample in found] == log.state.tolist()
    assert metadata["greywhale log"] == log.facts
    assert metadata["greywhale units"] == {
        f"{name}_{joint}": unit for name, unit in UNITS.items() for joint in range(4)
    }


def test_mat(recording: Recording, tmp_path: Path) -> None:
    """scipy reads it; Octave does in tests/oracles."""
    out, log = tmp_path / "log.mat", recording.log
    write("mat", [recording], out, NONE)
    held = loadmat(out, squeeze_me=True)
    for name, values in {"y": log.follower, "u": log.voltage, "leader": log.leader, "t": log.time}.items():
        np.testing.assert_array_equal(held[name], values)
    np.testing.assert_array_equal(held["external_torque"], 0.25 * log.voltage)
    assert (held["states"][held["state"] - 1] == log.state).all()
    assert float(held["Ts"]) == 0.001
    assert held["names"].tolist() == ["leader", "y", "u", "external_torque"]
    assert held["units"].tolist() == list(UNITS.values())
    assert json.loads(str(held["facts"])) == log.facts


def test_parquet(recording: Recording, tmp_path: Path) -> None:
    """pyarrow reads it; another reader does in tests/oracles."""
    out, log = tmp_path / "log.parquet", recording.log
    write("parquet", [recording], out, NONE)
    held = parquet.read_table(out)
    columns = ((column.name, column.unit, column[:]) for column in recording.columns)
    for name, unit, column in (("time_s", "s", log.time), *columns):
        np.testing.assert_array_equal(held[name].to_numpy(), column)
        assert held.schema.field(name).metadata == {b"unit": unit.encode()}
    assert held["state"].to_pylist() == log.state.tolist()
    assert {key.decode(): value.decode() for key, value in held.schema.metadata.items()} == log.facts


def test_bam(recording: Recording, tmp_path: Path) -> None:
    """The keys are those of BAM's own recordings, as its process.py and logs.py take them."""
    out, log = tmp_path / "log.json", recording.log
    write("bam", [recording], out, ExportOptions(joint=2, mass=0.49, length=0.1))
    held = json.loads(out.read_text())
    entries = held.pop("entries")
    facts = {"mass": 0.49, "length": 0.1, "kp": None, "vin": 15.0, "motor": "greywhale", "trajectory": "log"}
    assert held == facts | {"start_s": 12.5, "joint": 2}
    columns = {key: [entry[key] for entry in entries] for key in entries[0]}
    assert columns["position"] == log.follower[:, 2].tolist()
    assert columns["goal_position"] == log.leader[:, 2].tolist()
    np.testing.assert_allclose(np.multiply(columns["load"], 15.0) / 1000, log.voltage[:, 2], atol=1e-12)
    np.testing.assert_allclose(columns["timestamp"], log.time - 12.5, atol=1e-9)
    np.testing.assert_allclose(columns["speed"][1:-1], (log.follower[2:, 2] - log.follower[:-2, 2]) / 0.002, rtol=1e-6)
    assert columns["torque_enable"] == np.isin(log.state, ["soft_start", "following"]).tolist()
    assert set(columns["input_volts"]) == {15.0}


@pytest.mark.parametrize(
    ("options", "sentence"),
    [
        (ExportOptions(joint=1), "--to bam needs --joint, and --mass and --length"),
        (ExportOptions(1, 0.5, 0.1), "its header has no parameters, so nothing tells the supply"),
    ],
)
def test_what_bam_needs_is_named(recording: Recording, tmp_path: Path, options: ExportOptions, sentence: str) -> None:
    bare = replace(recording.log, origin=replace(recording.log.origin, table=None))
    with pytest.raises(UserError, match=sentence):
        write("bam", [Recording(bare)], tmp_path / "log.json", options)
    assert list(tmp_path.glob("*.json")) == []


def test_the_facts_are_those_of_the_header(recording: Recording, path: Path) -> None:
    header = dict(
        line[2:].split(": ", 1) for line in path.read_text().splitlines() if line.startswith("# ") and ": " in line
    )
    facts = recording.log.facts
    assert {key: value.strip() for key, value in header.items()} | {"check": "whole"} == facts
    assert "parameters.joint0" in facts


@pytest.mark.parametrize(
    ("given", "sentence"),
    [
        ({"logs": 2}, "--to odd takes one log, and 2 were given; call it once for each."),
        ({"options": ExportOptions(joint=1)}, "--joint does not go with --to odd; leave it out."),
        ({}, "--to odd needs the package not_there; install it: pip install 'greywhale[odd]'."),
    ],
)
def test_what_a_format_does_not_take_is_named(
    monkeypatch: pytest.MonkeyPatch, given: dict[str, Any], sentence: str
) -> None:
    monkeypatch.setitem(FORMATS, "odd", Format("Odd.", "odd:write", extra="odd", packages=("json", "not_there")))
    with pytest.raises(BadUsage) as refused:
        require_possible("odd", given.get("logs", 1), given.get("options", NONE))
    assert refused.value.message == sentence


def test_every_format_leads_to_a_writer() -> None:
    for one in FORMATS.values():
        module, _, name = one.writer.partition(":")
        assert callable(getattr(__import__(f"{formats.__package__}.{module}", fromlist=[name]), name))


TAKEN = {"bam": ExportOptions(1, 0.5, 0.1), "lerobot": ExportOptions(task="Wave")}


@pytest.fixture
def little_room() -> Iterator[None]:
    """No file may grow beyond 4 KB, as where the disk is full."""
    before = resource.getrlimit(resource.RLIMIT_FSIZE)
    resource.setrlimit(resource.RLIMIT_FSIZE, (4096, before[1]))
    yield
    resource.setrlimit(resource.RLIMIT_FSIZE, before)


@pytest.mark.parametrize("name", FORMATS)
def test_a_full_disk_is_said_and_leaves_nothing(
    recording: Recording, tmp_path: Path, name: str, little_room: None
) -> None:
    out = tmp_path / f"new.{name}"
    with pytest.raises(UserError, match="cannot be written: file too large"):
        write(name, [recording], out, TAKEN.get(name, NONE))
    assert [path.name for path in tmp_path.iterdir()] == ["log.csv"]
