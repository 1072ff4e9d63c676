"""Verbs that run for a page: the same answers, errors and files as in a terminal, and nothing outside of the folder."""

from __future__ import annotations

import contextlib
import io
import json
import queue
import re
import sys
from collections.abc import Iterator
from functools import partial
from pathlib import Path
from typing import Any

import pytest

from greywhale.base.errors import INTERRUPTED, UserError
from greywhale.base.formats.kinds import Kind
from greywhale.cli import entry
from greywhale.cli.catalogue import catalogue
from greywhale.cli.form_words import GROUPS, WORDS
from greywhale.dashboard.arm_answers import questions
from greywhale.dashboard.folder import Folder
from greywhale.dashboard.job import Facts
from greywhale.dashboard.jobs import Jobs
from greywhale.dashboard.verbs import command_line
from greywhale.files.arm import load_arm
from greywhale.files.log import read_log
from greywhale_sim.lockstep import LockStepBench
from tests.cli.example_log import write_log
from tests.dashboard.shared import PATIENCE_S, Desk, Shared
from tests.support.tellings import words, words_in


def in_a_terminal(words: list[str], folder: Path, monkeypatch: pytest.MonkeyPatch) -> tuple[int, str]:
    """The verb's exit code there, and what it prints."""
    monkeypatch.chdir(folder)
    with contextlib.redirect_stdout(io.StringIO()) as out, contextlib.redirect_stderr(io.StringIO()):
        code = entry.run(words)
    return code, out.getvalue()


@pytest.mark.slow
def test_a_verb_answers_and_fails_as_in_a_terminal(
    desk: Desk, bench: LockStepBench, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    job = desk.run("params backup", file="kept.toml")
    assert (job["state"], job["exit_code"], job["error"]) == ("done", 0, None), job
    assert job["result"]["port"] == bench.port
    write_log(tmp_path / "log.csv")
    for file in ("log.csv", "none.csv"):
        job = desk.run("evaluate", logs=[file])
        code, printed = in_a_terminal(["evaluate", file, "--json"], tmp_path, monkeypatch)
        answer = json.loads(printed)
        assert job["exit_code"] == code
        assert (job["result"] or {"error": job["error"], "exit_code": code}) == answer
        printed = in_a_terminal(["evaluate", file], tmp_path, monkeypatch)[1]
        assert words_in(job["telling"] or {"parts": []}) == words(printed)
    assert any(answer["error"] in line for line in job["said"])


@pytest.mark.slow
def test_a_recording_tells_how_far_it_is_and_keeps_what_it_has_when_it_is_stopped(desk: Desk, tmp_path: Path) -> None:
    id = desk.start("record", seconds=3600, out="long.csv")
    half = desk.wait(id, lambda facts: (facts["progress"] or {"done": 0})["done"] > 0)
    assert half["progress"] is not None
    assert half["progress"]["total"] == 1.0
    assert "record" in half["progress"]["text"]
    desk.jobs.stop(id)
    job = desk.wait(id)
    assert (job["state"], job["exit_code"]) == ("stopped", INTERRUPTED)
    assert read_log(tmp_path / "long.csv").time.size > 0


@pytest.mark.slow
def test_what_uses_the_board_ends_with_the_page_that_drives(desk: Desk) -> None:
    watcher = desk.shared.page(0)
    id = desk.start("record", seconds=3600)
    desk.wait(id, lambda facts: facts["progress"])
    with pytest.raises(UserError, match="another verb uses the board"):
        desk.start("info")
    word = watcher.words("driver")[-1]
    assert (word["job"], word["verb"]) == (id, "record")
    desk.shared.relay.leave(desk.page.client)
    assert desk.wait(id)["state"] == "stopped"


@pytest.mark.slow
def test_a_board_that_goes_away_ends_the_verb_with_its_sentence(desk: Desk, bench: LockStepBench) -> None:
    id = desk.start("record", seconds=3600)
    desk.wait(id, lambda facts: facts["progress"])
    desk.shared.relay.close(bench.port, "It was unplugged.")
    job = desk.wait(id)
    assert job["state"] == "failed"
    assert f"{bench.port}: the port went away" in (job["error"] or "")
    with pytest.raises(UserError, match="unplugged"):
        desk.start("info")


ECHO = "import json, sys; input(); print(json.dumps({'words': sys.argv[3:]}))"  # tells how it was called, when asked


def test_what_needs_the_port_itself_has_it_as_long_as_it_runs(shared: Shared, tmp_path: Path) -> None:
    events: list[str] = []
    told: queue.Queue[Facts] = queue.Queue()

    @contextlib.contextmanager
    def away(sentence: str) -> Iterator[str]:
        events.append(sentence)
        yield "the port"
        events.append("taken again")

    page = shared.page(0)
    jobs = Jobs(shared.relay, Folder(tmp_path), catalogue, [sys.executable, "-c", ECHO], away)
    jobs.listeners.append(lambda facts: told.put({**facts}))
    asked = {"verb": "flash", "arguments": {"hex_file": "a.hex"}}
    with pytest.raises(UserError, match="only watches"):
        jobs.start(asked, page.client.id)
    with pytest.raises(UserError, match="is no job"):
        jobs.stop("none")
    shared.relay.drive(page.client)
    shared.relay.close("the port", "No firmware answers there; flash it.")
    started = jobs.start(asked, page.client.id)
    assert started["state"] == "running"
    assert told.get(timeout=PATIENCE_S)["state"] == "running", "a page sees at once what it has started"
    with pytest.raises(UserError, match="still runs"):
        jobs.put_away(started["id"])
    jobs.say(started["id"], "go on")
    ended = told.get(timeout=PATIENCE_S)
    jobs.put_away(started["id"])
    assert told.get(timeout=PATIENCE_S)["kind"] == "gone", "other pages put its card away as well"
    assert jobs.facts() == []
    jobs.close()
    assert ended["result"]["words"] == ["-", "flash", "--hex=a.hex", "--port", "the port", "--json", "--"]
    assert events == ["`greywhale flash` has the port.", "taken again"]


VERBS = {one["verb"]: one for one in catalogue()}


def test_the_catalogue_is_that_of_the_command_line() -> None:
    record = {one["name"]: one for one in VERBS["record"]["arguments"]}
    assert (record["seconds"]["kind"], record["out"]["kind"], record["enable"]["kind"]) == ("number", "file", "flag")
    assert (record["ranges"]["option"], record["ranges"]["many"]) == ("--range", True)
    assert record["out"]["default"] == "log.csv"
    assert [VERBS[verb]["board"] for verb in ("tune", "record", "flash")] == ["none", "lent", "taken"]
    assert VERBS["tune"]["arguments"][0]["kind"] == "file"
    for verb in VERBS.values():
        assert verb["help"].endswith(".")
        assert verb["title"]
        assert verb["group"]
        labels = [one["label"] for one in verb["arguments"]]
        assert len(set(labels)) == len(labels), "an error names a field by its label"
        for one in verb["arguments"]:
            assert not one["required"] or one["first"], "what is needed is seen at once"
            assert not re.search("--|_", one["label"] + one["unit"]), "a label is no flag"
            assert re.fullmatch("[A-Z].*[^.]", one["label"])
        assert not {"port", "as_json"} & {one["name"] for one in verb["arguments"]}
        without_countdown = [one for one in verb["arguments"] if "without the countdown" in one["help"]]
        assert without_countdown == [], "on a page nobody leaves it out"


def test_each_word_of_the_forms_belongs_to_an_argument() -> None:
    """A label that stays behind when its option goes, or that two verbs say differently, is found here."""
    shown = {(verb, one["name"]) for verb, facts in VERBS.items() for one in facts["arguments"]}
    for key in WORDS:
        verb, _, name = key.rpartition(" ")
        assert (verb, name) in shown if verb else sum(name == one for _, one in shown) > 1, key
    for verbs in GROUPS.values():
        for verb, form in verbs.items():
            assert {(verb, name) for name in form.first} <= shown, verb
    assert {kind for facts in VERBS.values() for one in facts["arguments"] for kind in one["files"]} <= {
        *("log", "motion", "firmware"), *(kind.name.lower() for kind in Kind)
    }  # fmt: skip
    (said,) = (one["help"] for one in VERBS["record"]["arguments"] if one["name"] == "save_motion")
    assert said.startswith('With "Let greywhale lead the arm" or "Visits of each pose from either side": also write')


def test_the_form_of_an_arm_asks_what_follows_and_ends_as_an_arm_file(desk: Desk, tmp_path: Path) -> None:
    ask = partial(questions, folder=Folder(tmp_path))

    def names(answers: object) -> list[str]:
        return [one["where"] for group in ask(answers) for one in group["questions"]]

    assert "link[1].wall_mm" in names({})
    assert "link[1].height_mm" in names({"link[1].section": "bar"})
    assert not [name for name in names({"joints": "0,1"}) if name.startswith("joint[2]")]
    answers = {"name": "Bob", "joints": "0,1", "link[1].length_mm": "14 cm", "joint[1].same_motor": "no"}
    id = desk.start("arm new", answers=answers, out="bob.toml")
    ended = desk.wait(id)
    assert ended["state"] == "done", ended
    assert load_arm(tmp_path / "bob.toml").name == "Bob"
    given = {one["where"]: one["given"] for group in ask(ended["arguments"]["answers"]) for one in group["questions"]}
    assert ended["arguments"]["answers"] == "bob.answers.toml"
    assert [given[name] for name in ("name", "link[1].length_mm", "joint[1].same_motor")] == ["Bob", "140", "no"]
    with pytest.raises(UserError, match=r"Its length \(link\[1\].length_mm\) is 'long': that is no number."):
        desk.start("arm new", answers={**answers, "link[1].length_mm": "long"})
    with pytest.raises(UserError, match="it is not in"):
        desk.start("arm new", answers=answers, out="../bob.toml")


def test_words_are_those_of_the_command_line(tmp_path: Path) -> None:
    folder = Folder(tmp_path)
    assert command_line(VERBS["record"], {"enable": True, "seconds": 2, "out": "-x.csv"}, folder) == [
        *("record", "--seconds=2", "--enable", "--out=-x.csv", "--"),
    ]
    assert command_line(VERBS["evaluate"], {"logs": ["--help", "b.csv"]}, folder) == [
        *("evaluate", "--", "--help", "b.csv"),
    ]
    assert command_line(VERBS["params backup"], {"file": "a.toml", "overwrite": False}, folder) == [
        *("params", "backup", "--", "a.toml"),
    ]


@pytest.mark.parametrize(
    ("verb", "given", "reason"),
    [
        ("record", {"out": "../log.csv"}, "it is not in"),
        ("record", {"out": "/tmp/log.csv"}, "it is not in"),
        ("record", {"excite": True, "arm_file": "/etc/passwd"}, "it is not in"),
        ("record", {"ranges": ["0:-1:1", "x=/etc/passwd"]}, "it is not in"),
        ("evaluate", {"logs": ["log.csv", "way/log.csv"]}, "it is not in"),
        ("tune", {"model_file": "way/model.toml"}, "it is not in"),
        ("record", {"dance": 1}, "has no argument 'dance'"),
        ("record", {"enable": "yes"}, "true or false"),
        ("record", {"seconds": [1]}, "text or a number"),
        ("record", {"seconds": True}, "text or a number"),
        ("record", {"out": ""}, "text or a number"),
        ("record", {"out": "a\nb"}, "text or a number"),
        ("evaluate", {"logs": ["a.csv"] * 101}, "at most"),
    ],
)
def test_what_leads_out_of_the_folder_or_is_no_argument_is_refused(
    verb: str, given: dict[str, Any], reason: str, tmp_path: Path
) -> None:
    (tmp_path / "folder").mkdir()
    (tmp_path / "folder" / "way").symlink_to(tmp_path)
    with pytest.raises(UserError, match=reason):
        command_line(VERBS[verb], given, Folder(tmp_path / "folder"))
