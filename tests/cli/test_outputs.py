"""No verb writes over a file that it reads, nor over one that is there already, unless it is told to."""

from __future__ import annotations

import subprocess
import sys
from pathlib import Path

import pytest

from greywhale.cli.entry import run
from greywhale.cli.verbs import greywhale
from tests.cli.example_log import write_log
from tools.docs.schemas import commands

Captured = pytest.CaptureFixture[str]


@pytest.fixture
def alone(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    monkeypatch.chdir(tmp_path)
    return tmp_path


@pytest.mark.parametrize(
    "arguments",
    [
        ("identify", "one", "--out", "one"),
        ("identify", "other", "--validate", "one", "--out", "./one"),
        ("identify", "other", "--arm", "one", "--out", "one"),
        ("identify", "other", "--controller", "one", "--out", "one"),
        ("replay", "one", "--out", "one"),
        ("evaluate", "one", "--picture", "one"),
        ("export", "--urdf", "one", "--out", "one"),
        ("export", "--mjcf", "one", "--out", "one"),
        ("export", "--fis", "one", "--joint", "0", "--out", "one"),
        ("export", "--header", "one", "--joint", "0", "--out", "one"),
        ("fis", "other", "--controller", "one", "--joint", "0", "--out", "one"),
        ("record", "--excite", "--arm", "one", "--out", "one"),
        ("record", "--excite", "--arm", "one", "--save-motion", "one"),
        ("tune", "one", "--out", "one"),
    ],
)
def test_a_file_that_is_read_is_never_written(alone: Path, capsys: Captured, arguments: tuple[str, ...]) -> None:
    Path("one").write_text((Path(__file__).parents[2] / "shared/fuzzy_tables/table_10.toml").read_text())
    Path("other").write_text("nothing")
    before = Path("one").read_bytes()
    assert run(list(arguments)) == 2
    assert capsys.readouterr().err.startswith("greywhale: one: this file is read from")
    assert Path("one").read_bytes() == before


def test_log_and_motion_are_two_files(alone: Path, capsys: Captured) -> None:
    assert run(["record", "--excite", "--out", "a.csv", "--save-motion", "./a.csv"]) == 2
    assert "the log and the motion cannot be one file" in capsys.readouterr().err


@pytest.mark.parametrize(
    ("arguments", "sentence"),
    [
        (("identify", "log", "-o", "folder"), "folder: this is a folder"),
        (("record", "-o", "folder"), "folder: this is a folder"),
        (("record", "--excite", "--save-motion", "no/m.csv"), "no/m.csv: the folder no "),
        (("replay", "steps", "-o", "folder"), "folder: this is a folder"),
        (("evaluate", "log", "--picture", "no/a.png"), "no/a.png: the folder no "),
        (("tune", "log", "-o", "no/c.toml"), "no/c.toml: the folder no "),
        (("adapt", "log", "-o", "no/c.toml"), "no/c.toml: the folder no "),
        (("export", "--fis", "table", "--out", "no/x"), "no/x_joint0.fis: the folder no "),
        (("params", "backup", "no/b.toml"), "no/b.toml: the folder no "),
        (("compare", "-o", "no/a.csv"), "no/a.csv: the folder no "),
        (("commission", "-o", "log"), "log: logs, models"),
        (("reproduce", "-o", "log"), "log: report "),
        (("demo", "-o", "log"), "log: logs "),
    ],
)
def test_outputs_come_before_any_work(alone: Path, capsys: Captured, arguments: tuple[str, ...], sentence: str) -> None:
    """The log is none, and there is no board, so whatever came first would say so."""
    Path("log").write_text("nothing")
    Path("folder").mkdir()
    Path("table").write_bytes((Path(__file__).parents[2] / "shared/fuzzy_tables/table_10.toml").read_bytes())
    assert run(list(arguments)) == 2
    said = capsys.readouterr().err
    assert said.startswith(f"greywhale: {sentence}")
    assert said.count("\n") == 1
    assert sorted(path.name for path in alone.iterdir()) == ["folder", "log", "table"]


# Verbs that write files, with what they need to come to the outputs; `there` is there already.
WRITERS = (
    ("record", "-o", "there"),
    ("record", "--excite", "-o", "there"),
    ("record", "--excite", "--save-motion", "there"),
    ("replay", "steps", "-o", "there"),
    ("identify", "none", "-o", "there"),
    ("tune", "none", "-o", "there"),
    ("adapt", "none", "-o", "there"),
    ("evaluate", "none", "--picture", "there"),
    ("export", "--urdf", "default", "--out", "there"),
    ("export", "--fis", "table_10", "--joint", "0", "--out", "there"),
    ("export", "--header", "table_10", "--joint", "0", "--out", "there"),
    ("fis", "none", "--controller", "table_10", "--joint", "0", "--out", "there"),
    ("import", "none", "--from", "npz", "--out", "there"),
    ("compare", "-o", "there.csv"),
    ("params", "backup", "there"),
    ("calibrate", "--backup", "there"),
    ("arm", "new", "--answers", "none", "-o", "there"),
    ("arm", "import", "none", "-o", "there"),
    ("arm", "match", "default", "-o", "there"),
)


@pytest.mark.parametrize("arguments", WRITERS, ids=" ".join)
def test_a_file_that_is_there_is_kept_unless_told(alone: Path, capsys: Captured, arguments: tuple[str, ...]) -> None:
    """Refused before anything else: there is no board, and no input. With --overwrite that is what is missing."""
    name = arguments[-1]
    Path(name).write_text("kept")
    assert run(list(arguments)) == 2
    assert capsys.readouterr().err.startswith(f"greywhale: {name}: exists already; write over it with --overwrite")
    assert Path(name).read_text() == "kept"
    if arguments[0] in ("export", "compare"):  # which need nothing else
        more = ["--functions", "sphere", "--methods", "gwo,woa", "--budget", "30", "--seeds", "2", "--jobs", "1"]
        assert run([*arguments, "--overwrite", *(more if arguments[0] == "compare" else [])]) == 0
        assert Path(name).read_text() != "kept"
        return
    assert run([*arguments, "--overwrite"]) != 0
    assert "exists already" not in capsys.readouterr().err
    assert Path(name).read_text() == "kept"


@pytest.mark.parametrize(
    ("arguments", "name"),
    [
        (("record",), "log.csv"),
        (("replay", "steps"), "log.csv"),
        (("identify", "none"), "model.toml"),
        (("tune", "none"), "controller.toml"),
        (("calibrate",), "before-calibration.toml"),
        (("arm", "new"), "arm.toml"),
        (("arm", "match", "default"), "matched.toml"),
        (("export", "--fis", "table_10", "--out", "c.fis"), "c_joint2.fis"),
        (("identify", "none", "--pictures", "."), "responses_1.png"),
        (("tune", "none", "--pictures", "."), "sets.png"),
    ],
)
def test_so_is_one_with_a_name_that_nobody_gave(
    alone: Path, capsys: Captured, arguments: tuple[str, ...], name: str
) -> None:
    Path(name).write_text("kept")
    assert run(list(arguments)) == 2
    assert capsys.readouterr().err.startswith(f"greywhale: {name}: exists already; write over it with --overwrite")
    assert [path.name for path in alone.iterdir()] == [name]


OUTPUTS = {"out", "backup", "picture", "save_motion", "pictures"}
FOLDERS = ("demo", "commission", "reproduce")


def test_every_verb_that_writes_a_file_is_among_them() -> None:
    """Those with --overwrite; the folders of demo, commission and reproduce belong to these verbs."""
    options = {verb: {one.name for one in command.params} for verb, command in commands(greywhale)}
    writes = {verb for verb, names in options.items() if verb not in FOLDERS and OUTPUTS & names} | {"params backup"}
    assert writes == {verb for verb, names in options.items() if "overwrite" in names}
    assert writes == {" ".join(words[: 2 if words[0] in ("params", "arm") else 1]) for words in WRITERS}


@pytest.mark.slow
@pytest.mark.parametrize(
    ("arguments", "words"),
    [
        (["evaluate", "log.csv", "--picture", "x.bmp"], "x.bmp: pictures end in .png, .svg, .pdf."),
        (["compare", "--out", "x.txt"], "x.txt: reports end in .csv, .png, .svg, .pdf."),
        (["demo", "--controller", "none.toml"], "none.toml: cannot be read: no such file or directory."),
    ],
)
def test_a_wrong_name_is_refused_before_anything_slow_is_imported(
    arguments: list[str], words: str, tmp_path: Path
) -> None:
    write_log(tmp_path / "log.csv")
    code = (
        "import sys; from greywhale.cli import entry; entry.run(sys.argv[1:]); "
        "print(*{'cma', 'matplotlib', 'scipy.signal', 'greywhale.cli.story'} & set(sys.modules))"
    )
    done = subprocess.run(
        [sys.executable, "-c", code, *arguments], cwd=tmp_path, capture_output=True, text=True, check=False
    )
    assert (done.stdout, done.stderr) == ("\n", f"greywhale: {words}\n")
