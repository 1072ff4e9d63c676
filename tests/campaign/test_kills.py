"""Killed at any moment, verbs leave whole files and a board that is off; and what they must not leave is found."""

from __future__ import annotations

import mmap
from collections import Counter
from collections.abc import Iterator
from dataclasses import replace
from pathlib import Path

import pytest

from greywhale.board.device import Device
from greywhale.cli import verbs as cli
from greywhale.files.log import Log, read_log
from greywhale.formats import draft
from tools.campaign.kill_verbs import LEFT_OUT, VERBS
from tools.campaign.killing import Moment, run
from tools.campaign.parts.kills import PART, Stand, try_once

VERB = {verb.name: verb for verb in VERBS}


@pytest.fixture
def stand(request: pytest.FixtureRequest) -> Iterator[Stand]:
    with Stand(VERB[request.param]) as made:
        yield made


def try_all(stand: Stand, old: bool = True) -> tuple[Counter[str], Counter[str]]:
    """Kill the verb at each of its changes: what was wrong, and what was seen."""
    wrong: Counter[str] = Counter()
    seen: Counter[str] = Counter()
    for change in range(stand.ending.changes):
        found, met = try_once(stand, Moment(change=change, share=0.5), old)
        wrong.update(found)
        seen.update(met)
    return wrong, seen


@pytest.mark.parametrize(
    "verb",
    [
        *("record", "record --enable", "record --reconnect", "upload", "params backup", "export --fis", "info", "stop"),
        *("calibrate, the person's part left out", "arm new", "arm match", "arm import"),
    ],
)
def test_a_share_of_the_trials_breaks_nothing(verb: str) -> None:
    (row,) = PART.run({"verb": verb, "seed": 7, "trials": 16})
    assert (row.trials, row.violations) == (16, 0)


def test_every_verb_that_writes_or_moves_is_tried() -> None:
    tried = {piece["verb"].partition(",")[0].split(" --")[0] for piece in PART.pieces(1.0)}
    assert tried == {
        *("record", "replay", "upload", "params set", "params restore", "params backup", "export", "evaluate"),
        *("compare", "tune", "identify", "demo", "commission", "calibrate", "doctor", "arm new", "arm match"),
        *("arm import", "params get", "params diff", "info", "stop"),
    }
    assert {one.split()[0] for one in tried} | set(LEFT_OUT) == set(cli.VERBS)
    assert not {one.split()[0] for one in tried} & set(LEFT_OUT)
    assert sum(piece["trials"] for piece in PART.pieces(1.0) if piece["verb"] == "replay") == 1000


@pytest.mark.parametrize("stand", ["export --urdf"], indirect=True)
def test_between_any_two_changes_the_file_is_the_old_or_the_new_one(stand: Stand) -> None:
    wrong, seen = try_all(stand)
    assert not wrong
    # Named hidden, and not yet brought into the place of the old one.
    assert seen["hidden until the next run"] == 1
    assert try_all(stand, old=False)[1]["hidden until the next run"] == 0


@pytest.mark.parametrize("stand", ["export --urdf"], indirect=True)
def test_a_writer_that_writes_in_place_is_found(stand: Stand, monkeypatch: pytest.MonkeyPatch) -> None:
    def write_text(path: Path, text: str) -> None:
        with open(path, "wb", buffering=0) as file:
            file.write(text.encode())

    monkeypatch.setattr("greywhale.cli.export.write_text", write_text)
    wrong, _ = try_all(stand)
    assert wrong["arm.urdf is not what an unkilled run writes"] == 1  # the half


@pytest.mark.parametrize("stand", ["export --urdf"], indirect=True)
def test_hidden_files_that_nobody_sweeps_are_found(stand: Stand, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(draft, "sweep", lambda folder: None)
    wrong, _ = try_all(stand)
    assert [one for one in wrong if one.startswith(".greywhale-") and one.endswith(" stays")]


def test_what_a_held_verb_works_out_is_worked_out_once_for_all_trials(monkeypatch: pytest.MonkeyPatch) -> None:
    times = mmap.mmap(-1, 1)  # shared with the processes that are forked

    def counted(path: Path, voltages: bool) -> Log:
        times[0] += 1
        return read_log(path, voltages=voltages)

    monkeypatch.setattr("greywhale.cli.evaluate.read_log", counted)
    with Stand(VERB["evaluate --picture"]) as stand, stand.board() as board:
        endings = [stand.run(stand.folder(), board, Moment(change=change)) for change in (0, 1, stand.ending.changes)]
    assert [ending.code for ending in endings] == [None, None, 0]
    assert times[0] == 1


@pytest.mark.parametrize("stand", ["record --enable"], indirect=True)
def test_motors_without_a_lease_are_found(stand: Stand, monkeypatch: pytest.MonkeyPatch) -> None:
    enable = Device.enable
    monkeypatch.setattr(Device, "enable", lambda device, lease_ms: enable(device, 0))
    wrong, _ = try_all(stand, old=False)
    assert any("the motors are on after" in one and "(lease 0 ms)" in one for one in wrong)


def test_a_result_that_another_run_may_leave_out_is_not_promised() -> None:
    verb = replace(VERB["export --urdf"], more=r"arm\.u.*")
    with Stand(verb) as stand:
        assert (list(stand.whole), stand.promised) == (["arm.urdf"], [])
        wrong, _ = try_once(stand, Moment(change=0), old=False)
    assert not wrong
    with Stand(replace(verb, more="")) as stand:
        assert stand.promised == ["arm.urdf"]


@pytest.mark.parametrize("stand", ["upload"], indirect=True)
def test_a_set_that_nobody_asked_for_is_found(stand: Stand) -> None:
    with stand.board() as board:
        command = ["params", "set", "supply_mv=12000", "--port", board.port]
        assert run(command, stand.folder()).code == 0
        assert "the board keeps a set that nobody asked for" in board.settle()
