"""A page's questions beside the board: files, the arm, controllers and what a model predicts for them."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest

from greywhale.base import state
from greywhale.base.errors import UserError
from greywhale.dashboard.answers import Answers
from greywhale.dashboard.folder import Folder
from greywhale.dashboard.history import History
from greywhale.dashboard.predict import ROW_EVERY_TICKS, predict
from greywhale.dashboard.relay import Relay
from greywhale.files import controller, parameter_file
from greywhale.files.arm import content_of, load_arm
from greywhale.files.log.layout import HEADING, TITLE
from greywhale.protocol import schema
from greywhale.protocol.joints import parse
from greywhale.protocol.table import ParameterTable
from tests.dashboard.shared import jobs_of
from tests.files.older_parameters import write_older


@pytest.fixture
def answers(tmp_path: Path) -> Answers:
    """Its folder holds a file of each kind, and others."""
    folder = tmp_path / "folder"
    (folder / "out").mkdir(parents=True)
    (folder / "out" / "log.csv").write_text(f"# {TITLE}\n{HEADING}\n")
    (folder / "numbers.csv").write_text("a,b\n1,2\n")
    (folder / "broken.toml").write_bytes(b"\xff\xfe")
    (folder / "arm.toml").write_bytes(content_of("worn"))
    parameter_file.save(folder / "board.toml", ParameterTable.defaults())
    controller.save(folder / "c.toml", ParameterTable.defaults().controllers, "a <b>test</b>")
    (tmp_path / "secret.toml").write_bytes(content_of("worn"))
    (folder / "way.toml").symlink_to(tmp_path / "secret.toml")
    relay = Relay(History(10))
    return Answers(relay, Folder(folder), "default", jobs_of(relay, Folder(folder)))


def test_files_are_told_with_their_kind(answers: Answers) -> None:
    found = {one["name"]: one["kind"] for one in answers.state()["files"]}
    assert found == {"arm.toml": "arm", "board.toml": "parameters", "c.toml": "controller", "out/log.csv": "log"}


@pytest.mark.parametrize("name", ["../secret.toml", "/etc/passwd", "way.toml", "out/../../secret.toml", "", "a\0b"])
def test_a_name_never_leads_out_of_the_folder(answers: Answers, name: str) -> None:
    for ask in (answers.controller, answers.describe_arm):
        with pytest.raises(UserError, match="it is not in .*folder"):
            ask(name)


def test_the_arm_is_told_with_its_lengths_and_the_limits_of_its_joints(answers: Answers) -> None:
    told = answers.describe_arm(None)
    arm = load_arm("default")
    assert [(one["min"], one["max"]) for one in told["joints"]] == [(one.stops.min, one.stops.max) for one in arm.joint]
    assert told["lengths"] == [link.length for link in arm.link]
    assert answers.describe_arm("arm.toml")["name"] == load_arm("worn").name
    assert [one["fixed"] for one in answers.describe_arm("two_joints")["joints"]].count(True) == 2


def test_a_controller_is_told_as_a_board_stores_it(answers: Answers) -> None:
    table = ParameterTable.defaults()
    told = answers.controller("c.toml")
    assert told["source"] == "a <b>test</b>"
    assert table.with_raw(told["raw"]) == table
    assert answers.controller("board.toml")["raw"] == table.by_name()
    write_older(answers.folder.path / "older.toml", table, 1)
    assert set(table.by_name()) - set(answers.controller("older.toml")["raw"]) > {"driver", "joint0.ce_ticks"}
    write_older(answers.folder.path / "older.toml", table, 1)
    assert "driver" not in answers.controller("older.toml")["raw"]
    assert answers.controller("table_8")["raw"] == controller.load("table_8").raw_values()
    with pytest.raises(UserError, match=r"arm.toml: this is an arm file, but a controller file is needed"):
        answers.controller("arm.toml")


def test_a_prediction_is_the_closed_loops() -> None:
    found = predict(load_arm("default"), ParameterTable.defaults())
    for told in (found["step"], found["reach"]):
        leader, follower = np.array(told["leader"]), np.array(told["follower"])
        assert leader.shape == follower.shape == (len(told["time_s"]), 4)
        assert np.diff(told["time_s"]) == pytest.approx(ROW_EVERY_TICKS / 1000)
        mean = np.mean((leader - follower) ** 2, axis=0)
        assert told["mse"] == pytest.approx(mean, rel=0.05)


def test_how_a_board_is_wired_is_none_of_the_models() -> None:
    """Potentiometers mounted anyhow and motors the wrong way round: the model has neither."""
    arm, usual = load_arm("default"), ParameterTable.defaults()
    anyhow = usual.with_raw({"leader0.scale": -usual["leader0.scale"], "follower2.zero": 300, "joint1.motor_sign": -1})
    assert predict(arm, anyhow) == predict(arm, usual)


def test_joints_that_the_arm_lacks_stay_where_they_are() -> None:
    told = predict(load_arm("two_joints"), ParameterTable.defaults())["step"]
    moved = np.ptp(np.array(told["follower"]), axis=0) > 0.1
    assert tuple(np.flatnonzero(moved)) == load_arm("two_joints").joints_in_use == parse("0,1")


def test_what_a_board_would_refuse_is_not_predicted(answers: Answers) -> None:
    raw = list(schema.DEFAULTS)
    limits = [schema.PARAMETER_BY_NAME[f"joint0.limit_{end}"].index for end in ("min", "max")]
    raw[limits[0]] = raw[limits[1]] + 1
    for asked, reason in (
        ({"raw": raw, "board": 1}, "joint0.limit_min"),
        ({"raw": raw[1:], "board": 1}, "raw must be"),
        ({"raw": [*schema.DEFAULTS[1:], 1.5], "board": 1}, "raw must be"),
        ({"raw": list(schema.DEFAULTS), "board": "1"}, "board must be a number"),
        ({"raw": list(schema.DEFAULTS), "board": 77}, "77"),
        ({}, "raw must be"),
    ):
        with pytest.raises(UserError, match=reason):
            answers.predict(asked)


def test_calibrations_that_a_page_brings_are_kept_for_the_board_at_the_port(
    answers: Answers, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setenv(state.VARIABLE, str(tmp_path / "state"))
    raw = list(schema.DEFAULTS)
    with pytest.raises(UserError, match="no board is there yet"):
        answers.calibrations()
    answers.relay.close("/dev/none", "The board went away.")
    assert answers.calibrations() == {"calibrations": []}
    answers.keep_calibration({"raw": raw, "board": 1, "why": "found"})
    raw[schema.PARAMETER_BY_NAME["joint3.limit_max"].index] = 4096
    answers.keep_calibration({"raw": raw, "board": 1, "why": "page"})
    answers.keep_calibration({"raw": raw, "board": 1, "why": "back"})
    first, second = answers.calibrations()["calibrations"]
    assert (first["why"], second["why"]) == ("found", "page")
    assert second["changed"] == ["joint 3 (wrist roll): limits -143.2..143.2 to -143.2..57.3 degrees"]
    assert second["values"]["joint3.limit_max"] == 4096
    for wrong in ({"raw": raw, "board": 1, "why": "../x"}, {"raw": raw[1:], "board": 1, "why": "page"}):
        with pytest.raises(UserError, match="must be"):
            answers.keep_calibration(wrong)
    assert len(list((tmp_path / "state").rglob("*.toml"))) == 2
