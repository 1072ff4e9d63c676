"""Bench options of `greywhale dashboard --sim` reach the bench; `greywhale stop` names its holder."""

from __future__ import annotations

from pathlib import Path

import pytest

from greywhale.cli import dashboard, entry, stop
from greywhale.cli.bench import words_of
from greywhale_sim.faults import FAULTS
from greywhale_sim.serve import ServeOptions
from greywhale_sim.words import read


def started(*words: str) -> ServeOptions:
    """The bench that these words of the dashboard start."""
    with dashboard.command.make_context("dashboard", list(words)) as context:
        given = words_of(context.params)
    return read([word for one in given.values() for word in one])[0]


@pytest.mark.parametrize(
    ("words", "options"),
    [
        ((), {}),
        (("--blank", "--board", "nano"), {"blank": True, "board": "nano"}),
        (("--mistake", "pot-open", "--mistake", "motor-dead:2"), {"faults": ("pot-open", "motor-dead:2")}),
        (("--firmware", "a b.hex", "--eeprom", "-e.bin"), {"firmware": Path("a b.hex"), "eeprom": Path("-e.bin")}),
        (("--driver", "l298n"), {"driver": "l298n"}),
    ],
)
def test_the_bench_of_a_dashboard_is_that_of_sim(words: tuple[str, ...], options: dict[str, object]) -> None:
    assert started("--sim", *words) == ServeOptions(**options)  # type: ignore[arg-type]


def test_the_dashboard_lists_the_mistakes(capsys: pytest.CaptureFixture[str]) -> None:
    assert entry.run(["dashboard", "--sim", "--mistake", "list"]) == 0
    assert capsys.readouterr().out.count("\n") == len(FAULTS)


@pytest.mark.parametrize(
    ("more", "words"),
    [
        ({}, "what held the port (process 7) ends."),
        ({"goes_on": True}, "the dashboard (process 7) goes on, and starts no motor before a person asks anew."),
    ],
)
def test_stop_says_whether_what_held_the_port_goes_on(
    more: dict[str, bool], words: str, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    monkeypatch.setattr(stop, "choose_port", lambda port: port)
    monkeypatch.setattr(stop, "ask_to_stop", lambda port, wait_for_end: {"pid": 7, "state": "disabled", **more})
    assert entry.run(["stop", "--port", "ttyX"]) == 0
    assert capsys.readouterr().out == f"ttyX: motors off, state disabled; {words}\n"
