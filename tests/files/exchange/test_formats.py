"""Each format of other programs holds a log's numbers, words and facts; their own readers say so."""

from __future__ import annotations

import json
from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from greywhale.base.errors import BadUsage
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


def test_a_log_of_one_state_has_it_in_every_row(recording: Recording) -> None:
    """Such a log keeps the word once."""
    words = np.broadcast_to(np.array("following"), recording.log.time.shape)
    states = Recording(replace(recording.log, state=words)).states
    assert states.shape == words.shape
    assert set(states.tolist()) == {STATES.index("following")}


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
