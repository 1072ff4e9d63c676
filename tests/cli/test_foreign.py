"""Verbs of other distributions: found, listed and run; what is wrong with one of them leaves all others as they are."""

from __future__ import annotations

import itertools
import json
from collections.abc import Callable
from pathlib import Path

import pytest

from greywhale.base.errors import FAILED
from greywhale.cli import entry, foreign
from greywhale.cli.verbs import VERBS, all_verbs, place_of
from tests.cli.test_tracing import complete

Captured = pytest.CaptureFixture[str]
Install = Callable[..., str]
WAVE = """
import click
from greywhale.cli.foreign import Verb

@click.command()
def command():
    "Wave, at length."
    click.echo("waved")

VERB = Verb("Wave with the arm.", __name__ + ":command")
"""
numbers = itertools.count()


@pytest.fixture
def install(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Install:
    """Installs a distribution `waver` with one module; returns the name of that, which no other test has."""
    monkeypatch.syspath_prepend(str(tmp_path))

    def add(module: str = WAVE, verb: str = "wave", place: str = "VERB") -> str:
        name = f"waver_{next(numbers)}"
        (tmp_path / f"{name}.py").write_text(module, encoding="utf-8")
        facts = tmp_path / "waver-1.0.dist-info"
        facts.mkdir()
        (facts / "METADATA").write_text("Metadata-Version: 2.1\nName: waver\nVersion: 1.0\n", encoding="utf-8")
        (facts / "entry_points.txt").write_text(f"[{foreign.GROUP}]\n{verb} = {name}:{place}\n", encoding="utf-8")
        return name

    return add


def test_the_papers_verbs_are_found_and_nobody_elses_here() -> None:
    assert set(all_verbs()) - set(VERBS) == set(foreign.find()) == set(foreign.BRINGS)
    assert {str(one.dist.name) for one in foreign.find().values() if one.dist} == set(foreign.BRINGS.values())


def test_a_verb_is_listed_completed_and_run_as_the_others(install: Install, capsys: Captured) -> None:
    module = install()
    assert entry.run(["--help"]) == 0
    assert "Wave with the arm." in capsys.readouterr().out
    assert place_of("wave") == f"{module}:command"
    assert complete("greywhale wav") == ["wave"]
    assert entry.run(["wave"]) == 0
    assert capsys.readouterr() == ("waved\n", "")
    assert entry.run(["waev"]) == 2
    assert "Did you mean wave?" in capsys.readouterr().err


@pytest.mark.parametrize(
    ("module", "place", "reason"),
    [
        ("import a_module_that_is_not_there", "VERB", "No module named 'a_module_that_is_not_there'"),
        ("raise SystemExit('no licence')", "VERB", "SystemExit: no licence"),
        ("1 +", "VERB", "SyntaxError: invalid syntax"),
        ("", "VERB", "has no attribute 'VERB'"),
        ("VERB = 'wave'", "VERB", "is no greywhale.cli.foreign.Verb"),
        (WAVE, "VERB this is no place", "Error"),
        (WAVE.replace(":command", ":gone"), "VERB", "has no attribute 'gone'"),
        (WAVE.replace(":command", ":click"), "VERB", ":click is no click command"),
    ],
)
def test_a_broken_verb_is_one_sentence_that_names_its_distribution_and_all_others_are_whole(
    install: Install, capsys: Captured, module: str, place: str, reason: str
) -> None:
    others = all_verbs()
    install(module, place=place)
    assert entry.run(["wave", "--json"]) == FAILED
    captured = capsys.readouterr()
    sentence = json.loads(captured.out)["error"]
    assert captured.err == f"greywhale: {sentence}\n"
    assert sentence.startswith("wave, a verb of the distribution waver, cannot be loaded (")
    assert sentence.endswith("); install waver again, or remove it.")
    assert reason in sentence
    assert entry.run(["--help"]) == 0
    listed = capsys.readouterr().out
    assert all(f"\n  {verb} " in listed for verb in (*others, "wave"))
    assert entry.run(["compare", "--help"]) == 0
    assert {"udev", "upload"} <= set(complete("greywhale u"))
    assert complete("greywhale wav") == []


def test_no_distribution_takes_a_verb_of_greywhales_own(install: Install, capsys: Captured) -> None:
    install(verb="stop")
    assert entry.run(["stop", "--help"]) == 0
    assert capsys.readouterr().out.startswith("Usage: greywhale stop")
    assert all_verbs()["stop"] == VERBS["stop"]


@pytest.mark.parametrize("text", [b"\xff\xfe", b"[greywhale.verbs]\nno line of it"])
def test_a_distribution_whose_entry_points_are_no_text_is_passed_over(
    install: Install, tmp_path: Path, text: bytes
) -> None:
    install()
    (tmp_path / "waver-1.0.dist-info" / "entry_points.txt").write_bytes(text)
    assert set(foreign.find()) == set(foreign.BRINGS)


@pytest.mark.parametrize("verb", foreign.BRINGS)
def test_a_verb_whose_distribution_is_not_installed_says_what_to_install(
    verb: str, capsys: Captured, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(foreign, "distributions", list)
    assert entry.run([verb, "--json"]) == FAILED
    captured = capsys.readouterr()
    sentence = f"{verb} is no part of greywhale itself; install it: pip install greywhale-paper."
    assert json.loads(captured.out)["error"] == sentence
    assert captured.err == f"greywhale: {sentence}\n"
    assert entry.run(["--help"]) == 0
    assert f"\n  {verb} " not in capsys.readouterr().out
    assert complete(f"greywhale {verb}") == []


def test_greywhales_own_verbs_look_for_no_others(monkeypatch: pytest.MonkeyPatch, capsys: Captured) -> None:
    """That would read files of all distributions each time."""
    monkeypatch.setattr(foreign, "distributions", lambda: pytest.fail("distributions were read"))
    for arguments in (["--version"], ["udev"], ["stop", "--help"]):
        assert entry.run(arguments) == 0
