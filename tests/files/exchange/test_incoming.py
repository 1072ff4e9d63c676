"""Recordings of other programs become logs: ours come back byte for byte, and what is unclear is named."""

from __future__ import annotations

import json
import math
from pathlib import Path

import numpy as np
import pyarrow
import pytest
from pyarrow import parquet
from scipy.io import savemat

from greywhale.base.errors import UserError
from greywhale.files.exchange.columns import parse_rule
from greywhale.files.exchange.formats import write
from greywhale.files.exchange.incoming import Imported, import_log
from greywhale.files.exchange.recording import ExportOptions, Recording
from greywhale.files.log import LogWriter, read_log
from greywhale.measure import evaluate
from tests.files.exchange.example import example, write_example

OURS = ["mat", "npz", "parquet"]


def bring(path: Path, format_: str, *columns: str, joint: int | None = None) -> Imported:
    return import_log(path, format_, path.with_name("new.csv"), dict(map(parse_rule, columns)), joint)


@pytest.mark.parametrize("name", OURS)
def test_an_exported_log_comes_back_byte_for_byte(path: Path, name: str) -> None:
    out = path.with_suffix(f".{name}")
    write(name, [example(path)], out, ExportOptions())
    assert bring(out, name).joints == (0, 1, 2, 3)
    assert path.with_name("new.csv").read_bytes() == path.read_bytes()


@pytest.mark.parametrize("name", OURS)
def test_so_does_one_that_ended_early(path: Path, name: str) -> None:
    with pytest.raises(UserError), LogWriter(path, read_log(write_example(path)).origin) as log:
        for row in range(3):
            log.append(row / 1000, [0.1] * 4, [0.2] * 4, [0.3] * 4, "following")
        raise UserError("The cable came off.")
    out = path.with_suffix(f".{name}")
    write(name, [Recording(read_log(path))], out, ExportOptions())
    bring(out, name)
    assert path.with_name("new.csv").read_bytes() == path.read_bytes()
    assert read_log(path.with_name("new.csv")).ended_by == "The cable came off."


def test_a_changed_log_does_not_come_back_as_a_whole_one(path: Path) -> None:
    text = write_example(path).read_text()
    path.write_text(text.replace("12.500000,", "12.400000,"))
    out = path.with_suffix(".npz")
    write("npz", [Recording(read_log(path))], out, ExportOptions())
    with pytest.raises(UserError, match="the log from which it was exported was changed by its check"):
        bring(out, "npz")
    bring(out, "npz", "time_s=time_s")
    assert read_log(path.with_name("new.csv")).origin.board is None


def test_a_joint_that_bam_has_comes_back_with_its_numbers(path: Path) -> None:
    """BAM's file has one joint and no facts of a board; its states are on and off."""
    recording, out = example(path), path.with_suffix(".json")
    write("bam", [recording], out, ExportOptions(joint=2, mass=0.5, length=0.1))
    assert bring(out, "bam").joints == (2,)
    log, new = recording.log, read_log(path.with_name("new.csv"))
    np.testing.assert_array_equal(new.time, log.time)
    for name in ("leader", "follower", "voltage"):
        np.testing.assert_array_equal(getattr(new, name)[:, 2], getattr(log, name)[:, 2])
        assert not getattr(new, name)[:, [0, 1, 3]].any()
    assert new.joints_in_use == (2,)
    assert (new.state == "following").tolist() == np.isin(log.state, ["soft_start", "following"]).tolist()


@pytest.mark.parametrize(("motor", "full"), [("mx64", 1000), ("xl330", 885), ("xl330", 1)])
def test_bams_own_recording(path: Path, motor: str, full: int) -> None:
    """As its record.py writes one of a Dynamixel: a share of the supply that it reads beside it, in thousandths; of an
    XL330 in 1/885, as its register has it, or as it is. Below 0 it may be 16 bits without a sign.
    """
    loads = [-0.02 * full * row for row in range(5)]
    if full > 1:
        loads = [round(load) % 65536 for load in loads]
    entries = [
        {"position": 0.1 * row, "speed": 0.0, "load": loads[row], "input_volts": 7.3, "temp": 28}
        | {"timestamp": 0.0035 + 0.0052 * row, "goal_position": 0.2, "torque_enable": row < 3}
        for row in range(5)
    ]
    head = {"mass": 0.49, "length": 0.1, "kp": 100, "vin": 7.4, "motor": motor, "trajectory": "sin_sin"}
    path.with_suffix(".json").write_text(json.dumps(head | {"entries": entries}))
    assert bring(path.with_suffix(".json"), "bam", joint=1) == Imported(5, (1,), ())
    log = read_log(path.with_name("new.csv"))
    np.testing.assert_allclose(log.voltage[:, 1], -0.146 * np.arange(5), atol=7.3 / 885 / 2 + 5e-4)
    np.testing.assert_allclose(log.time, 0.0035 + 0.0052 * np.arange(5), atol=5e-7)
    np.testing.assert_allclose(log.follower[:, 1], 0.1 * np.arange(5))
    assert log.state.tolist() == ["following"] * 3 + ["disabled"] * 2


def test_a_load_that_was_interpolated_across_its_wrap_is_refused(path: Path) -> None:
    """As in BAM's processed recordings of such motors: no number of it can be trusted."""
    entries = [
        {"position": 0.0, "load": load, "input_volts": 7.3, "timestamp": 0.1 * row, "goal_position": 0.0}
        for row, load in enumerate((3, 32769.5, 65535))
    ]
    path.with_suffix(".json").write_text(json.dumps({"entries": entries}))
    with pytest.raises(UserError, match="row 2, column volts: voltage_0 would be 239.* beyond 33 V"):
        bring(path.with_suffix(".json"), "bam")


MAP = ("time_s=t,ms", "leader_0=goal,deg", "follower_0=q1,deg,-1,12.5", "voltage_0=u,mV")


def foreign(path: Path, kind: str) -> Path:
    """Two seconds of a follower that lags: degrees, the other way round and beside its zero, in ms and mV."""
    time = np.arange(0.0, 2000.0, 5.0)
    goal = 30.0 * np.sin(time / 200.0)
    q1 = -(30.0 * np.sin((time - 50.0) / 200.0) - 12.5)
    columns = {"t": time, "goal": goal, "q1": q1, "u": 100.0 * goal, "note": time}
    out = path.with_name(f"theirs.{kind}")
    if kind == "csv":
        rows = [
            ";".join(columns),
            *(";".join(map(repr, row)) for row in zip(*(c.tolist() for c in columns.values()), strict=True)),
        ]
        out.write_text("# of another tool\n" + "\n".join(rows) + "\n")
    elif kind == "parquet":
        parquet.write_table(pyarrow.table(columns), out)
    elif kind == "mat":
        savemat(out, columns)
    else:
        np.savez(out, **columns)  # type: ignore[arg-type]
    return out


@pytest.mark.parametrize("kind", ["csv", *OURS])
def test_columns_are_named_with_unit_sign_and_offset(path: Path, kind: str) -> None:
    assert bring(foreign(path, kind), kind, *MAP) == Imported(400, (0,), ())
    log = read_log(path.with_name("new.csv"))
    time = np.arange(0.0, 2.0, 0.005)
    np.testing.assert_allclose(log.time, time, atol=1e-9)
    np.testing.assert_allclose(log.leader[:, 0], math.radians(30.0) * np.sin(5.0 * time), atol=1e-6)
    np.testing.assert_allclose(log.follower[:, 0], math.radians(30.0) * np.sin(5.0 * (time - 0.05)), atol=1e-6)
    np.testing.assert_allclose(log.voltage[:, 0], 3.0 * np.sin(5.0 * time), atol=5e-4)
    assert evaluate(log).joints[0].delay_s == pytest.approx(0.05, abs=1e-3)


@pytest.mark.parametrize(
    ("columns", "sentence"),
    [
        (
            MAP[:3],
            "nothing says what voltage_0 of a log is; say it with --column voltage_0=NAME, one of t, goal, q1, u",
        ),
        (MAP[1:], "nothing says what time_s of a log is"),
        ((), "what time_s, leader_0, follower_0, voltage_0 of a log are"),
        ((*MAP[:3], "voltage_0=volts"), "it has no column volts; it has t, goal, q1, u, note"),
        (
            ("time_s=t,ms", "leader_0=goal", *MAP[2:]),
            "row 12, column goal: leader_0 would be 8.*beyond 8 rad; say its unit",
        ),
        (("time_s=goal", *MAP[1:]), "row 65, column goal: time must increase by a microsecond or more"),
        ((*MAP, "state=note"), "row 1, column note: 0.0 is no state; a log has boot"),
        (("q=q1",), "a log has no column q; it has time_s"),
        (("follower_0",), "it must be such as --column follower_0=q1,deg,-1,12.5"),
        (("follower_0=q1,grad",), "grad is no unit of follower_0; give one of rad, deg, mrad, rev"),
        (("follower_0=q1,deg,2",), "the sign is 2, but it must be 1 or -1"),
        (("follower_0=q1,deg,1,x",), "the offset x is not a number"),
        (("state=q1,deg",), "states are words"),
    ],
)
def test_what_is_unclear_is_named_and_nothing_is_written(path: Path, columns: tuple[str, ...], sentence: str) -> None:
    with pytest.raises(UserError, match=sentence):
        bring(foreign(path, "csv"), "csv", *columns)
    assert not path.with_name("new.csv").exists()


@pytest.mark.parametrize("kind", ["bam", "csv", *OURS])
def test_a_file_of_another_kind_is_refused(path: Path, kind: str) -> None:
    path.write_bytes(b"\x89PNG\r\n\x1a\n\0\xff")
    with pytest.raises(UserError, match=f"cannot be read as {kind}: "):
        bring(path, kind)


def test_doubts_about_units_are_said(path: Path) -> None:
    """Seconds that are ms, and angles beyond half a turn."""
    columns = {"t": np.arange(100.0), "q": np.linspace(0.0, 5.0, 100)}
    np.savez(path.with_suffix(".npz"), **columns)  # type: ignore[arg-type]
    found = bring(path.with_suffix(".npz"), "npz", "time_s=t", "leader_0=q", "follower_0=q", "voltage_0=q")
    assert ["is time_s in ms?" in found.remarks[0], "are they in degrees?" in found.remarks[1]] == [True, True]
