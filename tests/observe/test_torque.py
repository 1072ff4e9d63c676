"""Outside torques of an identified arm that somebody pushes."""

from __future__ import annotations

import json
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

from greywhale.arm import ArmParameters
from greywhale.base.errors import UserError
from greywhale.cli import entry
from greywhale.files.arm import load_arm
from greywhale.files.log import Log
from greywhale.loop import human_reaches
from greywhale.observe import (
    LIVE_EVERY_TICKS,
    ExternalTorque,
    Sight,
    Told,
    contacts_in,
    estimate_external_torque,
    live_torque,
)
from greywhale.protocol import schema
from greywhale.protocol.joints import ALL
from tools.support.pushed_arm import OwnPlant, Push, judge, record_pushed, some_pushes
from tools.support.recordings import record, table_of

MODEL = Path(__file__).parent / "default_model.toml"  # as `greywhale identify` found the default arm in a log of 25 s
SECONDS = 14.0
pytestmark = pytest.mark.slow


@pytest.fixture(scope="module")
def model() -> ArmParameters:
    return load_arm(str(MODEL))


@pytest.fixture(scope="module")
def pushes() -> list[Push]:
    return some_pushes(load_arm("default"), SECONDS, (0.25, 0.5), 3)


@pytest.fixture(scope="module")
def pushed(pushes: list[Push], tmp_path_factory: pytest.TempPathFactory) -> Log:
    arm, motion = load_arm("default"), human_reaches(77, SECONDS)
    path = tmp_path_factory.mktemp("pushed") / "log.csv"
    return record_pushed(OwnPlant(arm, motion.angles[0], 5), arm, motion, path, table_of("before_tuning"), pushes, 5)


@pytest.fixture(scope="module")
def found(pushed: Log, model: ArmParameters) -> ExternalTorque:
    return estimate_external_torque(pushed, model)


def test_a_push_is_measured_within_a_tenth_of_the_stall_torque(
    found: ExternalTorque, pushed: Log, pushes: list[Push]
) -> None:
    judged = judge(found, pushed, load_arm("default"), pushes)
    assert min(len(one) for one in judged.error) > 100
    assert [float(np.quantile(np.abs(one), 0.9)) for one in judged.error] == pytest.approx([0.0] * 4, abs=0.1)
    assert np.mean(np.concatenate(judged.held)) > 0.9
    # An interval that holds all would say nothing; of roll only that something pushes it, as its links are light.
    assert max(float(np.median(one)) for one in judged.half_width[:3]) < 0.1


def test_a_push_is_seen_within_50_ms(found: ExternalTorque, pushed: Log, pushes: list[Push]) -> None:
    judged = judge(found, pushed, load_arm("default"), pushes)
    assert np.isfinite(judged.seen).all()
    assert np.count_nonzero(judged.seen <= 0.05) >= len(pushes) - 1
    assert judged.false == ()


def test_free_motion_is_no_contact(model: ArmParameters, tmp_path: Path) -> None:
    log = record(load_arm("default"), human_reaches(78, 30.0), tmp_path / "free.csv", table_of("before_tuning"), 78)
    free = estimate_external_torque(log, model)
    assert free.contacts == ()
    assert free.told.mean() > 0.08
    assert (np.abs(free.torque) <= free.half_width)[free.told].mean() > 0.9


def test_a_joint_at_rest_tells_nothing_that_friction_can_hold(found: ExternalTorque, model: ArmParameters) -> None:
    resting = found.sight == Sight.RESTING
    for joint in range(4):
        held = model.joint[joint].friction.breakaway
        assert (found.half_width[resting[:, joint], joint] > held).all()
    facts = found.as_dict()["joints"][1]
    assert facts["not_told"]["resting"] == pytest.approx(resting[:, 1].mean())
    assert 1.0 - sum(facts["not_told"].values()) == pytest.approx(found.told[:, 1].mean())


def test_nothing_is_told_while_motors_are_off(pushed: Log, model: ArmParameters) -> None:
    state = pushed.state.copy()
    state[2000:4000] = "disabled"
    found = estimate_external_torque(replace(pushed, state=state), model)
    assert (found.sight[2000:4000] == Sight.OFF).all()
    assert (found.torque[2000:4000] == 0.0).all()
    assert not found.told[4000:4040].any(), "it begins anew"


def test_every_fourth_sample_tells_much_the_same(pushed: Log, found: ExternalTorque, model: ArmParameters) -> None:
    columns = {name: getattr(pushed, name)[::4] for name in ("time", "leader", "follower", "voltage", "state")}
    slow = estimate_external_torque(replace(pushed, **columns), model)
    both = slow.told & found.told[::4]
    assert both.sum() > 500
    stall = [model.actuator(joint).torque_per_volt * model.drive.supply for joint in range(4)]
    assert np.sqrt(np.mean(((slow.torque - found.torque[::4]) / stall)[both] ** 2)) < 0.05


def test_a_lost_sample_of_a_board_is_no_contact(pushed: Log, pushes: list[Push], model: ArmParameters) -> None:
    """Some are lost before most pushes, while the arm moves; and a board's samples come a few at a time."""
    rows = np.arange(0, len(pushed.time), LIVE_EVERY_TICKS)
    lost = [round(1000 * one.begin) - 100 for one in pushes[1:]]
    rows = rows[~np.any([(rows >= first) & (rows < first + 40) for first in lost], axis=0)]
    samples = [_sample(pushed, row) for row in rows]
    live = live_torque(model, table_of("before_tuning")["filter_shift"])
    pieces = [live.feed_samples(samples[first : first + 10]) for first in range(0, len(samples), 10)]
    told = Told(*(np.concatenate(column) for column in zip(*pieces, strict=True)))
    assert [one.joint for one in contacts_in(pushed.time[rows], told, ALL)] == [one.joint for one in pushes]
    assert len(lost) > 5


def _sample(log: Log, row: int) -> schema.Sample:
    """A row as the board sent it; nobody asks where its leader is."""
    follower, voltage = (
        tuple(np.rint(values[row] / schema.Sample.LSB[name]).astype(int).tolist())
        for name, values in (("follower", log.follower), ("voltage", log.voltage))
    )
    tick = round(1000 * log.time[row])
    return schema.Sample(tick, schema.State.FOLLOWING, schema.Fault.NONE, (0, 0, 0, 0), follower, voltage)


def test_an_arm_file_that_was_not_identified_is_refused(pushed: Log) -> None:
    with pytest.raises(UserError, match=r"use a model\.toml of greywhale identify"):
        estimate_external_torque(pushed, load_arm("default"))


def test_evaluate_tells_torques_and_contacts(
    pushed: Log, pushes: list[Push], capsys: pytest.CaptureFixture[str]
) -> None:
    assert entry.run(["evaluate", pushed.name, "--model", str(MODEL)]) == 0
    said = capsys.readouterr().out
    assert "can be told" in said
    assert said.count("Contact: joint") == len(pushes)
    assert entry.run(["evaluate", pushed.name, "--model", str(MODEL), "--json"]) == 0
    answer = json.loads(capsys.readouterr().out)["logs"][0]["external_torque"]
    sizes = [one["torque_nm"] for one in answer["contacts"]]
    assert [np.sign(one) for one in sizes] == [np.sign(push.torque) for push in pushes]


def test_an_export_has_the_torque_beside_the_logs_quantities(
    pushed: Log, found: ExternalTorque, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    out = tmp_path / "log.npz"
    assert entry.run(["export", pushed.name, "--to", "npz", "--model", str(MODEL), "--out", str(out)]) == 0
    with np.load(out) as arrays:
        assert np.array_equal(arrays["external_torque"], np.where(found.told, found.torque, 0.0))
        assert np.array_equal(arrays["external_torque_half_width"], found.half_width)
        assert np.array_equal(arrays["external_torque_told"], found.told)
    assert entry.run(["export", pushed.name, "--to", "bam", "--model", str(MODEL), "--out", str(out)]) == 2
    assert "--model does not go with --to bam" in capsys.readouterr().err
