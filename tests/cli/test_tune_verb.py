"""`greywhale tune` as people and scripts meet it: refusals before any work, Ctrl-C and --resume, the file it writes."""

from __future__ import annotations

import contextlib
import itertools
import json
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from greywhale.cli import entry
from greywhale.cli import tune as verb
from greywhale.files import controller
from greywhale.loop import default_controller
from greywhale.protocol import schema
from greywhale.tune.limits import WITHOUT_FLOORS
from tests.board.fake_board import FakeBoard
from tests.support.sentences import names
from tests.support.tuning import judge_nothing, shorten
from tests.tune.models import log_facts, write_model
from tools import ROOT

Captured = pytest.CaptureFixture[str]
CHANGING = (schema.ParamSetRequest, schema.ParamApplyRequest, schema.ParamSaveRequest)
# Small, but the whole way: a search, its margins, its held-out motions.
QUICK = ("--method", "random", "--budget", "4", "--samples", "1")


@pytest.fixture
def model(tmp_path: Path) -> Path:
    return write_model(tmp_path / "model.toml")


@pytest.fixture
def no_work(monkeypatch: pytest.MonkeyPatch) -> None:
    """Whatever is refused must be refused before the search."""

    def forbidden(*arguments: Any, **options: Any) -> None:
        raise AssertionError("the search was begun")

    monkeypatch.setattr(verb, "tune", forbidden)


@pytest.fixture
def no_floors(monkeypatch: pytest.MonkeyPatch) -> None:
    """The least possible errors take seconds and are tested with the floor."""
    shorten(monkeypatch)
    monkeypatch.setattr(verb, "TUNING_LIMITS", WITHOUT_FLOORS)


# --- refusals -------------------------------------------------------------------------------------------------------


@pytest.mark.parametrize(
    ("code", "words", "things"),
    [
        (2, "model.toml --budget many", "--budget many integer"),
        (2, "model.toml --method newton", "--method newton default paper"),
        (2, "model.toml --samples 0", "samples 0 1"),
        (2, "model.toml --bounds Ku=3-9", "--bounds Ku=3-9 NAME=LOW..HIGH"),
        (2, "model.toml --bounds Ku=nan..9", "bounds Ku nan 9 finite"),
        (2, f"model.toml --budget 1{30 * '0'}", f"budget 1{30 * '0'} 1000000"),
        (2, "model.toml --seed 2147483648", "seed 2147483648 2147483647"),
        (2, "model.toml --workers 100000", "workers 100000 1024"),
        (2, "model.toml --bounds Ku=3..9 --bounds ku=3..8", "--bounds ku=3..8 Ku already"),
        (2, "model.toml --out /dev/null", "/dev/null ordinary file"),
        (2, "model.toml --resume", "controller.toml.journal no interrupted"),
        (1, "model.toml --start none.toml", "none.toml no file"),
        (1, "model.toml --start model.toml", "model.toml model controller file"),
        (1, "table.toml", "table.toml controller file model"),
        (1, "model.toml --params table.toml", "table.toml controller file parameter"),
        (1, "doubtful.toml", "doubtful.toml not validated second log record"),
        (1, "default", "default nothing identified arm file"),
        (1, "log.csv", "log.csv TOML"),
    ],
)
def test_what_will_not_do_is_named_before_any_work(
    no_work: None, model: Path, monkeypatch: pytest.MonkeyPatch, capsys: Captured, code: int, words: str, things: str
) -> None:
    monkeypatch.chdir(model.parent)
    write_model(Path("doubtful.toml"), log=[log_facts()])
    Path("log.csv").write_text("time_s,leader_0\n0.0,1.0\n", encoding="utf-8")
    Path("table.toml").write_bytes((ROOT / "shared/fuzzy_tables/table_10.toml").read_bytes())
    before = sorted(path.name for path in model.parent.iterdir())
    assert entry.run(["tune", *words.split()]) == code
    said = capsys.readouterr()
    assert said.out == ""
    assert names(said.err, f"greywhale: {things}")
    assert said.err.count("\n") == 1
    assert sorted(path.name for path in model.parent.iterdir()) == before


# --- what it writes -------------------------------------------------------------------------------------------------


@pytest.mark.slow
def test_json_file_and_upload_speak_of_the_same_controllers_within_their_bounds_and_pictures_are_drawn(
    no_floors: None, model: Path, monkeypatch: pytest.MonkeyPatch, capsys: Captured
) -> None:
    judge_nothing(monkeypatch)
    out, folder = model.parent / "controller.toml", model.parent / "pictures"
    more = ("--bounds", "Ku=3..5", "--bounds", "ze_c=0.02..0.03", "--pictures", str(folder), "--json")
    assert entry.run(["tune", str(model), "--out", str(out), *QUICK, *more]) == 0
    said = capsys.readouterr()
    assert said.out.count("\n") == 1
    answer = json.loads(said.out)
    assert answer["files"][0] == str(out)
    pictures = [Path(name) for name in answer["files"][1:]]
    assert pictures
    assert all(path.parent == folder and path.read_bytes().startswith(b"\x89PNG") for path in pictures)
    assert sorted(path.name for path in model.parent.iterdir()) == ["controller.toml", "model.toml", "pictures"]
    assert_bounds_hold_even_for_what_the_board_ran_before(answer)
    assert_the_file_tells_the_same(answer, out)


def assert_the_file_tells_the_same(answer: dict[str, Any], out: Path) -> None:
    written = controller.load(out)
    told = {name: schema.PARAMETER_BY_NAME[name].to_raw_as_given(value) for name, value in answer["after"].items()}
    assert len(told) == 52
    assert told.items() <= written.raw_values().items()
    assert written.tuning is not None
    assert written.table().crc == int(str(written.tuning["parameter_crc"]), 16)
    assert (written.tuning["status"], written.tuning["method"]) == ("complete", "random")


def assert_bounds_hold_even_for_what_the_board_ran_before(answer: dict[str, Any]) -> None:
    before, after = (
        {key: [answer[when][f"joint{joint}.{key}"] for joint in range(4)] for key in ("ku_mv", "ze_c")}
        for when in ("before", "after")
    )
    assert min(before["ku_mv"]) > 5000
    assert min(after["ku_mv"]) >= 3000
    assert max(after["ku_mv"]) <= 5000
    widths = np.array(after["ze_c"])
    assert widths.min() >= 0.02 - 1e-4
    assert widths.max() <= 0.03 + 1e-4


@pytest.mark.parametrize(
    ("tuning", "warnings"),
    [
        (None, []),
        ({"status": "complete", "margins_hold": True, "period_ms": 1, "supply_v": 15.0}, []),
        (
            {"status": "unfinished", "period_ms": 20, "supply_v": 12.0},
            ["not finished", "period_ms = 20, but this board has 1", "supply_mv = 12000, but this board has 15000"],
        ),
        ({"board": "nano328"}, ["for the board nano328, but this board is a mega2560"]),
        ({"margins_hold": False}, ["a margin does not hold"]),
        (
            {"margins_hold": False, "notes": [f"joint {joint}, at rest: it turns round" for joint in range(4)]},
            ["margins do not hold: joint 0, at rest; joint 1, at rest; joint 2, at rest and 1 more"],
        ),
        (
            {"follows_worse": ["joint 3 (wrist roll) on steps, 3.9 times the error"]},
            ["follows worse than before the tuning: joint 3 (wrist roll) on steps, 3.9 times the error."],
        ),
    ],
)
def test_an_upload_warns_where_board_and_tuning_differ(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: Captured, tuning: dict[str, Any] | None,
    warnings: list[str],
) -> None:  # fmt: skip
    controller.save(tmp_path / "c.toml", default_controller(), tuning=tuning)
    with FakeBoard() as board:
        assert entry.run(["upload", str(tmp_path / "c.toml"), "--port", board.port, "--json"]) == 0
        told = json.loads(capsys.readouterr().out)["warnings"]
        assert [one for one, words in zip(told, warnings, strict=True) if words not in one] == []
        assert entry.run(["upload", str(tmp_path / "c.toml"), "--port", board.port]) == 0
    said = capsys.readouterr()
    assert said.err == "".join(f"Warning: {warning}\n" for warning in told)
    assert "Warning" not in said.out


@pytest.mark.parametrize(("answer", "code"), [(False, 1), (True, 0)])
@pytest.mark.parametrize("tuning", [{"margins_hold": False}, {"follows_worse": ["joint 0 (base yaw) on steps, ..."]}])
def test_a_terminal_is_asked_before_controllers_are_stored_that_are_worse(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, answer: bool, code: int, tuning: dict[str, Any]
) -> None:
    monkeypatch.setattr("greywhale.cli.upload.sys.stdin.isatty", lambda: True)
    monkeypatch.setattr("greywhale.cli.upload.Terminal.agrees", lambda terminal, question: answer)
    controller.save(tmp_path / "c.toml", default_controller(), tuning=tuning)
    with FakeBoard() as board:
        assert entry.run(["upload", str(tmp_path / "c.toml"), "--port", board.port]) == code
        assert (board.asked(schema.ParamSaveRequest) > 0) is answer


def test_an_upload_warns_before_it_stores(tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: Captured) -> None:
    """Whoever sees the warning and presses Ctrl-C keeps what the board had."""
    controller.save(tmp_path / "c.toml", default_controller(), tuning={"period_ms": 20})

    def echo(text: str, err: bool) -> None:
        assert "period_ms = 20" in text
        raise KeyboardInterrupt

    monkeypatch.setattr("greywhale.cli.upload.click.echo", echo)
    with FakeBoard() as board:
        assert entry.run(["upload", str(tmp_path / "c.toml"), "--port", board.port]) == 130
        assert board.asked(schema.ParamGetRequest) > 0
        assert [board.asked(request) for request in CHANGING] == [0, 0, 0]


# --- Ctrl-C ---------------------------------------------------------------------------------------------------------

LONG = ("--method", "gwo-woa", "--budget", "31", "--samples", "1")


def interrupt_after(monkeypatch: pytest.MonkeyPatch, batches: int) -> None:
    """Ctrl-C as the progress bar is told of that batch."""
    told = itertools.count(1)

    def report(what: str, fraction: float, note: str = "") -> None:
        if next(told) == batches:
            raise KeyboardInterrupt

    monkeypatch.setattr(verb, "progress", lambda brief=False: contextlib.nullcontext(report))


@pytest.mark.slow
def test_interrupted_and_resumed_is_the_same_file_as_uninterrupted(
    no_floors: None, model: Path, monkeypatch: pytest.MonkeyPatch, capsys: Captured
) -> None:
    judge_nothing(monkeypatch)
    folder = model.parent
    monkeypatch.chdir(folder)
    out, journal = folder / "controller.toml", folder / "controller.toml.journal"
    tune_long = ("tune", "model.toml", *LONG)
    for batches, options in ((2, ("--workers", "1")), (4, ("--workers", "2", "--resume"))):
        with monkeypatch.context() as patch:
            interrupt_after(patch, batches)
            assert entry.run([*tune_long, *options]) == 130
        said = capsys.readouterr()
        assert said.out == ""
        assert "interrupted. The best controllers so far are in controller.toml, marked as unfinished" in said.err
        unfinished = controller.load(out)
        assert unfinished.tuning is not None
        assert unfinished.tuning["status"].startswith("unfinished")
        assert unfinished.source.endswith("(unfinished)")
        assert journal.exists()
        assert not list(folder.glob(".*"))
    assert_only_the_same_goes_on(tune_long, (journal, out), capsys)
    assert entry.run([*tune_long, "--resume", "--json"]) == 0
    assert not journal.exists()
    assert entry.run([*tune_long, "--out", "whole.toml", "--json"]) == 0
    assert out.read_bytes() == Path("whole.toml").read_bytes()


def assert_only_the_same_goes_on(tune_long: tuple[str, ...], kept: tuple[Path, Path], capsys: Captured) -> None:
    """Any other tuning is refused, and nothing is changed."""
    before = [path.read_bytes() for path in kept]
    model = Path("model.toml").read_bytes()
    other_model = write_model(Path("other.toml"), deviation=0.031).read_bytes()
    for option, content, words in (
        (("--method", "gwo"), model, 'its method is "gwo-woa", now it is "gwo";'),
        (("--budget", "70"), model, "its budget is 31, now it is 70;"),
        (("--bounds", "Ku=3..9"), model, 'its bounds is {}, now it is {"Ku": [3.0, 9.0]};'),
        ((), other_model, "its model_digest is"),
    ):
        Path("model.toml").write_bytes(content)
        assert entry.run([*tune_long, *option, "--resume"]) != 0
        assert f"the journal is of another tuning: {words}" in capsys.readouterr().err
        assert [path.read_bytes() for path in kept] == before
    Path("model.toml").write_bytes(model)
