"""The command line as people and scripts meet it: exit codes, one JSON object, one sentence, never a traceback."""

from __future__ import annotations

import json
import os
import subprocess
import sys
from collections.abc import Callable
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from greywhale.base.runtime import VARIABLE
from greywhale.cli import entry
from greywhale.cli.verbs import all_verbs
from greywhale.files.leader import save_leader
from greywhale.files.log import read_log
from greywhale.files.trajectory import Trajectory
from greywhale.protocol import schema
from greywhale.protocol.ports import find_ports
from greywhale.protocol.schema import State
from greywhale.protocol.table import ParameterTable
from greywhale_sim.serve import ServeOptions, running
from tests.board.fake_board import FakeBoard, Faults
from tests.board.port_board import PortBoard, locked
from tests.cli.example_log import write_log
from tests.files.older_parameters import write_older
from tests.support.sentences import names
from tools import ROOT

TABLE_10 = str(ROOT / "shared" / "fuzzy_tables" / "table_10.toml")
Captured = pytest.CaptureFixture[str]


def ask(captured: Captured, *arguments: str) -> tuple[int, dict[str, Any]]:
    """Exit code and the one JSON object on stdout."""
    code = entry.run([*arguments, "--json"])
    out = captured.readouterr().out
    assert out.count("\n") == 1
    answer = json.loads(out)
    assert isinstance(answer, dict)
    return code, answer


# --- every verb -----------------------------------------------------------------------------------------------------


OF_GROUPS = ("params get", "params set", "params backup", "params restore", "params diff")


@pytest.mark.parametrize("verb", [*all_verbs(), *OF_GROUPS, "arm import", "arm new", "arm match"])
def test_every_verb_has_help_and_json(verb: str, capsys: Captured) -> None:
    assert entry.run([*verb.split(), "--help"]) == 0
    text = capsys.readouterr().out
    assert text.startswith(f"Usage: greywhale {verb}")
    assert "--json" in text or verb in ("params", "arm")


@pytest.mark.parametrize("group", [[], ["params"], ["arm"]])
def test_alone_the_program_and_its_groups_show_their_help(group: list[str], capsys: Captured) -> None:
    assert entry.run([*group, "--help"]) == 0
    help_text = capsys.readouterr().out
    assert entry.run(group) == 0
    assert capsys.readouterr() == (help_text, "")


def test_help_needs_no_heavy_imports() -> None:
    code = "import sys; from greywhale.cli import entry; entry.run(['--help']); print(*sys.modules)"
    done = subprocess.run([sys.executable, "-c", code], check=True, stdout=subprocess.PIPE, text=True)
    imported = set(done.stdout.splitlines()[-1].split())
    assert "greywhale_paper.verbs" in imported
    assert not imported & {"matplotlib", "greywhale_paper.cli"}


def test_the_program_starts_no_threads_for_linear_algebra() -> None:
    code = "import greywhale.__main__, numpy, threadpoolctl; print(threadpoolctl.threadpool_info()[0]['num_threads'])"
    own = {name: value for name, value in os.environ.items() if name != "OPENBLAS_NUM_THREADS"}
    assert subprocess.run([sys.executable, "-c", code], check=True, env=own, stdout=subprocess.PIPE).stdout == b"1\n"


@pytest.mark.parametrize(
    ("arguments", "things"),
    [
        (["dance"], "dance greywhale --help"),
        (["recrod"], "recrod record"),
        (["params", "gett"], "gett get"),
        (["record", "--secnds", "3"], "--secnds --seconds"),
        (["record", "--disengaged"], "--disengaged --enable"),
        (["upload"], "CONTROLLER"),
        (["flash", "--firmware", "a", "--hex", "b"], "--firmware --hex exclude"),
        (["params", "set", "joint0.kp"], "joint0.kp NAME=VALUE"),
        (["params", "set", "supply_mv=12A"], "supply_mv 12A A mV V"),
        (["params", "set", "joint0.kp=65"], "joint0.kp 65 1/rad range"),
        (["params", "set", "joint0.kp=1", "joint0.kp=2"], "joint0.kp twice"),
        (["params", "get", "\x1b[31m" + "x" * 5000], "no parameter"),
        (["record", "--poses", "3", "--excite"], "--excite --poses"),
        (["record", "--poses", "3", "--enable"], "--poses --enable"),
        (["record", "--poses", "3", "--seconds", "4"], "--poses --seconds"),
        (["record", "--poses", "3", "--seed", "4"], "--seed --excite"),
        (["record", "--arm", "default"], "--arm --excite --poses"),
        (["evaluate", "log.csv", "--arm", "default"], "--arm --repeatability"),
        (["evaluate", "log.csv", "--repeatability", "--model", "m.toml"], "--model --repeatability"),
        (["record", "--excite", "--budget", "1000000"], "budget 1000000 100000"),
        (["compare", "--jobs", "100000"], "100000 1024"),
        (["reproduce", "--seeds", "1001"], "seeds 1001 1000"),
        (["sim", "--eeprom", "none/e.bin"], "none/e.bin folder none create"),
        (["sim", "--blank", "--firmware", "a.hex"], "blank firmware --blank --firmware"),
        (["dashboard", "--sim", "--port", "p"], "--sim --port --sim"),
        (["dashboard", "--blank"], "--blank --sim"),
        (["dashboard", "--mistake", "list"], "--mistake --sim"),
        (["dashboard", "--board", "nano"], "--board --sim"),
        (["calibrate", "--backup", "none/b.toml"], "none/b.toml folder none create"),
        (["record", "--out", ""], "--out empty"),
        (["evaluate", ""], "argument empty"),
        (["info"], "no board port"),
    ],
)
def test_bad_usage_is_exit_code_2_and_names_the_thing_and_the_value(
    arguments: list[str], things: str, capsys: Captured
) -> None:
    assert entry.run(arguments) == 2
    captured = capsys.readouterr()
    assert captured.out == ""
    assert captured.err.startswith("greywhale: ")
    assert names(captured.err, things)
    assert len(captured.err) < 1020
    assert captured.err[:-1].isprintable()
    code, answer = ask(capsys, *arguments)
    assert (code, answer["exit_code"]) == (2, 2)
    assert names(answer["error"], things)


@pytest.mark.parametrize(
    ("arguments", "things"),
    [
        (["info", "--port", "/dev/none"], "/dev/none no port"),
        (["evaluate", "none.csv"], "none.csv no file"),
        (["upload", "before_tunning"], "before_tunning no file before_tuning"),
        (["export", "--urdf", "defalt", "--out", "a"], "defalt no file default"),
    ],
)
def test_failures_are_exit_code_1_and_name_the_thing(arguments: list[str], things: str, capsys: Captured) -> None:
    code, answer = ask(capsys, *arguments)
    assert (code, answer["exit_code"]) == (1, 1)
    assert names(answer["error"], things)


def test_a_whole_sentence_says_what_where_and_what_to_do(capsys: Captured) -> None:
    """One for all others, of which tests compare the things and the values that they name."""
    _, answer = ask(capsys, "sim", "--eeprom", "none/e.bin")
    assert answer["error"] == "none/e.bin: the folder none does not exist; create it, or write elsewhere."


# --- with a board ---------------------------------------------------------------------------------------------------


def test_info_tells_version_crc_state_and_counters(capsys: Captured) -> None:
    with FakeBoard() as board:
        code, answer = ask(capsys, "info", "--port", board.port)
        assert entry.run(["info", "--port", board.port]) == 0
        text = capsys.readouterr().out
    assert code == 0
    assert answer["firmware"] == "0.1.0"
    assert answer["parameter_crc"] == f"0x{schema.param_crc(schema.DEFAULTS):04x}"
    assert (answer["state"], answer["fault"], answer["tick_us_max"]) == ("disabled", "none", 300)
    assert "Arduino Mega 2560" in text
    assert "longest tick   300 us of 1000, 0 late" in text
    assert "pots           none is at a rail" in text


@pytest.mark.parametrize(
    ("source", "saves", "words"),
    [
        (schema.ParamSource.DEFAULTS, 0, "built-in defaults; the EEPROM held no valid set\n"),
        (schema.ParamSource.DEFAULTS, 2, "built-in defaults; the EEPROM held no valid set; a set was stored since\n"),
        (schema.ParamSource.BANK_B, 2, "EEPROM bank B\n"),
    ],
)
def test_info_tells_where_parameters_came_from_then_and_what_is_stored_now(
    source: schema.ParamSource, saves: int, words: str, capsys: Captured
) -> None:
    with FakeBoard() as board:
        board.param_source, board.saves = source, saves
        assert entry.run(["info", "--port", board.port]) == 0
    assert f"at the start   they came from {words}" in capsys.readouterr().out.replace("\n" + " " * 15, " ")


def test_info_names_a_fault_with_its_place_and_remedy(capsys: Captured) -> None:
    board = FakeBoard()
    board.state, board.fault, board.fault_where = State.FAULT, schema.Fault.POT_LOW, 5
    with board:
        assert entry.run(["info", "--port", board.port]) == 0
    assert "lower rail (follower potentiometer 1): check that" in capsys.readouterr().out


def test_a_broken_pot_is_named_before_anything_moves(tmp_path: Path, capsys: Captured) -> None:
    with FakeBoard(Faults(followers=(0, 0, -10725, 0))) as board:
        assert entry.run(["info", "--port", board.port]) == 0
        text = capsys.readouterr().out
        _, answer = ask(capsys, "info", "--port", board.port)
        out = tmp_path / "log.csv"
        code, refused = ask(capsys, "record", "--excite", "--yes", "--port", board.port, "-o", str(out))
        assert board.asked(schema.LeadRequest) == 0
    told = "follower potentiometer 2 reads 0..0 of 1023, at a rail (pot_low)"
    assert text.splitlines()[-1].startswith(f"pots           {told}")
    assert [pot["pot"] for pot in answer["pots"] if pot["fault"] == "pot_low"] == ["follower2"]
    assert code == 1
    assert told in refused["error"]


def test_the_port_may_come_from_the_environment(capsys: Captured, monkeypatch: pytest.MonkeyPatch) -> None:
    with FakeBoard() as board:
        monkeypatch.setenv("GREYWHALE_PORT", board.port)
        assert ask(capsys, "stop")[1] == {"port": board.port, "state": "disabled", "restarted": True}


def test_stop_begins_with_what_helps_where_it_cannot(capsys: Captured) -> None:
    """Here a program that is not ours has the port."""
    with PortBoard() as board, locked(board.port) as holder:
        assert entry.run(["stop", "--port", board.port]) == 1
    said = capsys.readouterr().err
    assert said.startswith("greywhale: Switch the motors' supply off: ")
    assert f"{board.port}: the port is in use by process {holder} (" in said


def test_poses_that_are_too_near_are_refused_before_the_first_sweep(capsys: Captured) -> None:
    with FakeBoard() as board:
        assert entry.run(["calibrate", "--second", "45,45,5,45", "--port", board.port]) == 2
        assert "differ by 0.087 rad at joint 2" in capsys.readouterr().err
        assert board.asked(schema.ParamGetRequest) == 0


def test_upload_tells_what_changed(capsys: Captured) -> None:
    with FakeBoard() as board:
        code, answer = ask(capsys, "upload", TABLE_10, "--port", board.port)
        assert code == 0
        assert answer["parameter_crc"] == f"0x{schema.param_crc(board.stored):04x}"
        assert "joint0.pce_b" in answer["changed"]
        assert entry.run(["upload", TABLE_10, "--port", board.port]) == 0
    assert "nothing had to change" in capsys.readouterr().out


def test_a_bad_controller_is_refused_before_the_board_is_touched(tmp_path: Path, capsys: Captured) -> None:
    bad = tmp_path / "bad.toml"
    bad.write_text(Path(TABLE_10).read_text().replace("Pce_b = 1.0", "Pce_b = 1.5", 1))
    with FakeBoard() as board:
        code, answer = ask(capsys, "upload", str(bad), "--port", board.port)
        assert board.requests == []
    assert code == 1
    assert "Pce_b is 1.5, but it must be at least 0.01 and at most 1" in answer["error"]


def test_params_set_get_backup_diff_restore(tmp_path: Path, capsys: Captured) -> None:
    backup = str(tmp_path / "backup.toml")
    with FakeBoard() as board:
        at = ["--port", board.port]
        assert ask(capsys, "params", "backup", backup, *at)[0] == 0
        changed = ask(capsys, "params", "set", "joint1.kp=0.5", "supply_mv=12000", *at)[1]["changed"]
        assert changed == ["supply_mv", "joint1.kp"]
        assert board.stored == board.running
        rounded = ask(capsys, "params", "set", "joint1.kp=0.5000061", *at)[1]
        assert rounded["changed"] == []
        assert rounded["stored"] == {"joint1.kp": 0.5}
        values = ask(capsys, "params", "get", "joint1.kp", "supply_mv", *at)[1]["parameters"]
        assert values == {"joint1.kp": 0.5, "supply_mv": 12000}
        group = ask(capsys, "params", "get", "joint1", "joint1.kp", "stall", *at)[1]["parameters"]
        assert set(group) == {
            *(one.name for one in schema.PARAMETERS if one.name.startswith("joint1.")), "stall_volts", "stall_time",
        }  # fmt: skip
        assert group["joint1.kp"] == 0.5
        differences = ask(capsys, "params", "diff", backup, *at)[1]["differences"]
        assert differences["supply_mv"] == {"board": 12000, "file": 15000}
        assert set(differences) == {"supply_mv", "joint1.kp"}
        assert ask(capsys, "params", "restore", backup, *at)[0] == 0
        assert board.stored == list(schema.DEFAULTS)
        assert ask(capsys, "params", "diff", backup, *at)[1]["differences"] == {}


# What a board has that an older file does not state, and a restore would reset.
NEWER = {"driver": 2, "estop_input": 2, "joint2.ratio": 32}


@pytest.fixture
def older(tmp_path: Path) -> str:
    """A backup of the first layout, with another supply."""
    path = tmp_path / "older.toml"
    write_older(path, ParameterTable.defaults().with_raw({"supply_mv": 12000}), 1)
    return str(path)


def board_with(values: dict[str, int]) -> FakeBoard:
    board = FakeBoard()
    for name, raw in values.items():
        index = schema.PARAMETER_BY_NAME[name].index
        board.running[index] = board.stored[index] = board.staged[index] = raw
    return board


@pytest.mark.parametrize("missing", ["kept", "board", "defaults"])
def test_restoring_an_older_file_resets_nothing_without_a_word(older: str, missing: str, capsys: Captured) -> None:
    with board_with(NEWER) as board:
        choice = [] if missing == "kept" else ["--missing", missing]
        code, answer = ask(capsys, "params", "restore", older, *choice, "--port", board.port)
        raw = {one.name: value for one, value in zip(schema.PARAMETERS, board.stored, strict=True)}
    assert code == 0
    assert raw["supply_mv"] == 12000
    assert set(NEWER) <= set(answer["not_in_file"])
    if missing == "defaults":
        assert [raw[name] for name in NEWER] == [schema.PARAMETER_BY_NAME[name].default for name in NEWER]
        assert answer["kept"] == []
        assert set(answer["changed"]) == {"supply_mv", *NEWER}
    else:
        assert {name: raw[name] for name in NEWER} == NEWER
        assert answer["changed"] == ["supply_mv"]
        assert set(answer["kept"]) == set(NEWER)


def test_what_a_restore_keeps_is_named_and_an_older_file_without_difference_says_nothing(
    older: str, capsys: Captured
) -> None:
    with board_with(NEWER) as board:
        assert entry.run(["params", "restore", older, "--port", board.port]) == 0
        said = capsys.readouterr().out
        assert (
            "does not state these; they keep the board's values: estop_input = 2, driver = 2, joint2.ratio = 0.5."
            in said
        )
    with board_with({}) as board:
        assert entry.run(["params", "restore", older, "--port", board.port]) == 0
        assert capsys.readouterr().out == f"{board.port}: changed and stored supply_mv.\n"


@pytest.mark.parametrize(("answer", "code"), [(True, 0), (False, 1)])
def test_a_terminal_is_asked_what_becomes_of_what_an_older_file_does_not_state(
    older: str, monkeypatch: pytest.MonkeyPatch, capsys: Captured, answer: bool, code: int
) -> None:
    monkeypatch.setattr("greywhale.cli.params.sys.stdin.isatty", lambda: True)
    monkeypatch.setattr("greywhale.cli.params.Terminal.agrees", lambda terminal, question: answer)
    with board_with(NEWER) as board:
        assert entry.run(["params", "restore", older, "--port", board.port]) == code
        said = capsys.readouterr().err
        assert f"{older} is older and does not state estop_input = 2, driver = 2, joint2.ratio = 0.5." in said
        assert ("nothing was restored; --missing defaults" in said) is not answer
        assert (board.asked(schema.ParamSaveRequest) > 0) is answer


def test_a_difference_is_never_from_what_the_file_does_not_state(older: str, capsys: Captured) -> None:
    with board_with(NEWER) as board:
        answer = ask(capsys, "params", "diff", older, "--port", board.port)[1]
        assert answer["differences"]["driver"] == {"board": 2, "file": None}
        assert set(answer["differences"]) == {"supply_mv", *NEWER}
        assert entry.run(["params", "diff", older, "--port", board.port]) == 0
        said = capsys.readouterr().out.splitlines()
    assert ["driver", "2", "not", "there"] in [line.split() for line in said]
    assert (
        f"{older} is older and does not state {len(answer['not_in_file'])} parameters; the others are compared."
        == said[-1]
    )


@pytest.mark.parametrize("verb", ["record", "record --enable", "replay"])
def test_a_port_that_goes_away_ends_the_log_whole_and_says_so_once(verb: str, tmp_path: Path, capsys: Captured) -> None:
    out, motion = tmp_path / "log.csv", tmp_path / "motion.csv"
    save_leader(motion, Trajectory(np.array([0.0, 600.0]), np.zeros((2, 4))))
    options = {"record": ["-s", "600"], "record --enable": ["-s", "600"], "replay": [str(motion), "--yes"]}[verb]
    with FakeBoard(Faults(unplug_at=300)) as board:
        code = entry.run(["-q", *verb.split(), *options, "-o", str(out), "--port", board.port])
    said = capsys.readouterr().err
    log = read_log(out)
    assert (code, log.complete, said.count(log.ended_by)) == (1, False, 1)
    assert log.ended_by.startswith(f"{board.port}: the port went away")
    assert ("within 500 ms" in said) == (verb != "record")
    assert f"What was recorded is in {out}, marked as interrupted." in said
    assert 200 < len(log.time) < 300
    assert sorted(os.listdir(tmp_path)) == ["log.csv", "motion.csv"]


@pytest.mark.parametrize("motors", ["--enable", "--excite"])
def test_reconnecting_is_for_logs_with_the_motors_off(motors: str, tmp_path: Path, capsys: Captured) -> None:
    out = tmp_path / "log.csv"
    assert entry.run(["record", "--reconnect", motors, "-o", str(out), "--port", "/dev/none"]) == 2
    assert capsys.readouterr().err.startswith("greywhale: --reconnect is for logs with the motors off")
    assert not out.exists()


# --- evaluate -------------------------------------------------------------------------------------------------------


def test_evaluate_prints_a_table_for_people(tmp_path: Path, capsys: Captured) -> None:
    write_log(tmp_path / "log.csv")
    assert entry.run(["evaluate", str(tmp_path / "log.csv")]) == 0
    lines = capsys.readouterr().out.splitlines()
    assert lines[0].endswith("1000 samples, 1.00 s")
    assert lines[3].split() == ["joint", "0", "0.010000", "0.1000", "0.1000", "n/a", "n/a", "n/a", "n/a"]
    assert lines[7].split() == ["total", "0.040000"]
    assert max(map(len, lines[1:])) <= 80


def test_evaluate_warns_of_a_log_that_is_not_as_it_was_recorded(tmp_path: Path, capsys: Captured) -> None:
    path = tmp_path / "log.csv"
    write_log(path)
    lines = path.read_text().splitlines(keepends=True)
    path.write_text("".join([*lines[:300], *lines[700:]]))
    assert entry.run(["evaluate", str(path)]) == 0
    said = capsys.readouterr().out.splitlines()
    assert said[0].endswith("600 samples, 0.60 s of the log's 1.00 s")
    code, answer = ask(capsys, "evaluate", str(path))
    (facts,) = answer["logs"]
    assert (code, facts["check"]) == (0, "shortened")
    assert said[-2:] == [f"Warning: {remark}" for remark in facts["remarks"]]
    assert facts["gaps"] == [{"after_s": 0.288, "length_s": 0.401, "samples": 400}]
    assert (facts["duration_s"], facts["span_s"]) == pytest.approx((0.598, 0.999))


def test_a_log_is_replayed_with_a_warning_where_it_is_not_as_it_was_recorded(tmp_path: Path, capsys: Captured) -> None:
    path, out = tmp_path / "log.csv", tmp_path / "again.csv"
    write_log(path, 0.2)
    path.write_text(path.read_text().replace(",0.100000", ",0.110000", 1))
    with FakeBoard() as board:
        assert entry.run(["replay", str(path), "-o", str(out), "--yes", "--port", board.port, "--json"]) == 0
    answer, said = capsys.readouterr()
    (remark,) = json.loads(answer)["warnings"]
    assert remark.startswith(f"{path}: its check fails")
    assert said.startswith(f"Warning: {remark}\n")


def test_a_bad_log_leaves_no_picture(tmp_path: Path, capsys: Captured) -> None:
    write_log(tmp_path / "log.csv")
    text = (tmp_path / "log.csv").read_text()
    for old, new, words in (
        ("0.100000", "inf", "line 12, column leader_0: inf is not a finite number"),
        ("0.999000", "inf", "line 1011, column time_s: inf is not a finite number"),
        ("0.999000", "1e308", "line 1011, column time_s: 1e308 s is beyond 1e+10 s; times are in s"),
    ):
        (tmp_path / "log.csv").write_text(text.replace(old, new, 1))
        code, answer = ask(capsys, "evaluate", str(tmp_path / "log.csv"), "--picture", str(tmp_path / "p.png"))
        assert code == 1
        assert words in answer["error"]
        assert not (tmp_path / "p.png").exists()


# --- ports, bench ---------------------------------------------------------------------------------------------------


def test_ports_without_any(capsys: Captured, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr("greywhale.cli.ports.find_ports", list)
    assert ask(capsys, "ports") == (0, {"ports": []})
    assert entry.run(["ports"]) == 0
    assert "greywhale sim" in capsys.readouterr().out


def test_sim_says_on_stderr_the_name_that_other_verbs_use(
    tmp_path: Path, capsys: Captured, monkeypatch: pytest.MonkeyPatch
) -> None:
    """And what to do next; standard output is the port alone."""
    monkeypatch.setenv(VARIABLE, str(tmp_path))
    found: list[str] = []

    def serve_once(options: ServeOptions, on_ready: Callable[[str], None], note: Callable[[str], None]) -> None:
        with running(options, note=note) as server:
            on_ready(server.port.path)
            found.extend([server.port.path, *(port.device for port in find_ports() if port.bench)])

    monkeypatch.setattr("greywhale_sim.serve.serve", serve_once)
    assert entry.run(["sim", "--speed", "max"]) == 0
    captured = capsys.readouterr()
    port, name = found
    assert captured.out == f"{port}\n"
    assert captured.err.startswith(f"greywhale: this bench is {name}; greywhale finds it by itself")
    assert "greywhale info" in captured.err
