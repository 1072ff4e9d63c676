"""Results of verbs as data: a terminal prints all of it, and the next steps are verbs with arguments that they take."""

from __future__ import annotations

from pathlib import Path

import pytest

from greywhale.base.telling import Column, Row, Table, Telling
from greywhale.cli import entry
from greywhale.cli.catalogue import catalogue
from greywhale.dashboard.folder import Folder
from greywhale.dashboard.verbs import command_line
from greywhale.protocol.table import ParameterTable
from tests.cli.example_log import write_log
from tests.cli.test_wrapping import seen_on
from tests.support.tellings import told_by_verbs, words, words_in

__all__ = ["told_by_verbs"]
VIEW = "calibrate"  # a step that a page has a view for, and no form


def test_a_terminal_prints_what_a_page_is_told(told_by_verbs: dict[str, tuple[Telling, str]]) -> None:
    assert set(told_by_verbs) == {one["verb"] for one in catalogue()}
    for verb, (telling, printed) in told_by_verbs.items():
        assert printed == f"{telling.text()}\n", verb
        assert words_in(telling.as_dict()) == words(printed), verb


def test_each_next_step_is_a_verb_of_the_page_with_arguments_that_it_takes(
    told_by_verbs: dict[str, tuple[Telling, str]], tmp_path: Path
) -> None:
    known = {one["verb"]: one for one in catalogue()}
    steps = {verb: [step.verb for step in telling.steps] for verb, (telling, _) in told_by_verbs.items()}
    assert steps["record"] == ["evaluate"]
    assert steps["identify"] == ["tune", "record"]
    assert steps["tune"] == ["upload", "commission"]
    assert told_by_verbs["commission"][0].steps[0].given == {"model": "model.toml"}
    for telling, _ in told_by_verbs.values():
        for step in (one for one in telling.steps if one.verb != VIEW):
            needed = {one["name"] for one in known[step.verb]["arguments"] if one["required"]}
            assert needed <= set(step.given)
            assert command_line(known[step.verb], dict(step.given), Folder(tmp_path))


def test_a_terminal_gets_the_next_step_and_a_pipe_the_result_alone(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    monkeypatch.chdir(tmp_path)
    write_log(Path("a log.csv"))
    assert entry.run(["evaluate", "a log.csv"]) == 0
    piped = capsys.readouterr().out
    said = seen_on(100, monkeypatch, "stdout", ["evaluate", "a log.csv"])
    assert said == f"{piped}Next: greywhale identify 'a log.csv'\n"
    shipped = ParameterTable.defaults()
    write_log(Path("before.csv"), table=shipped)
    write_log(Path("after.csv"), table=shipped.with_raw({"joint2.kp": shipped["joint2.kp"] + 1}))
    for logs, offered in ((["before.csv"], True), (["after.csv"], False), (["before.csv", "after.csv"], False)):
        assert ("Next: " in seen_on(100, monkeypatch, "stdout", ["evaluate", *logs])) is offered


def test_a_row_keeps_its_columns_and_its_words_where_a_cell_is_too_long() -> None:
    columns = (
        Column("motion", width=6, left=True),
        Column("error\n", "rad", 5),
        Column(width=4, left=True),
        Column("s"),
    )
    rows = [
        Row(("steps", "0.1", "ab", "1")),
        Row(("all of them", "0.2", "abcdefgh", "22"), remark="worse"),
        Row(("more",)),
    ]
    assert Telling((Table(columns, rows),)).text().split("\n") == [
        "motion error        s",
        "       [rad]",
        "steps    0.1 ab     1",
        "all of them 0.2 abcdefgh 22   worse",
        "more",
    ]
