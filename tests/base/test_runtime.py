"""The folder for what runs now is this user's alone: whatever else lies in its place is not trusted."""

from __future__ import annotations

import os
import subprocess
import sys
import tempfile
from pathlib import Path

import pytest

from greywhale.base import runtime, system
from greywhale.base.errors import UserError
from greywhale.base.runtime import VARIABLE, make_runtime_directory, private_runtime_directories, runtime_directories
from greywhale.protocol import ports


@pytest.fixture
def place(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    """The folder's, in one that other users can write."""
    tmp_path.chmod(0o1777)
    monkeypatch.setenv(VARIABLE, str(tmp_path / "run"))
    return tmp_path / "run"


def test_the_folder_follows_from_the_user_alone(monkeypatch: pytest.MonkeyPatch) -> None:
    """A cron job, a notebook and `su -` have other variables than the terminal next to them."""
    monkeypatch.delenv(VARIABLE)
    before = runtime_directories()
    for name in ("XDG_RUNTIME_DIR", "TMPDIR", "HOME"):
        monkeypatch.setenv(name, "/nowhere")
    monkeypatch.setattr(tempfile, "tempdir", "/nowhere")
    assert runtime_directories() == before
    assert all(str(os.getuid()) in str(folder) for folder in before)


def test_benches_are_found_in_the_second_folder_too(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """One may have begun before its user logged in, and so before the first was there."""
    folders = [tmp_path / "user" / "greywhale", tmp_path / "greywhale-user"]
    monkeypatch.setattr(runtime, "runtime_directories", lambda: folders)
    assert make_runtime_directory() == folders[1]
    (tmp_path / "user").mkdir()
    assert make_runtime_directory() == folders[0]
    (folders[1] / f"mega-{os.getpid()}").symlink_to("/dev/null")
    assert ports.is_bench("/dev/null")


def take_the_name(kind: str) -> Path:
    """Put something in the folder's place, as another user or a careless one may."""
    (folder,) = runtime_directories()
    match kind:
        case "open":
            folder.mkdir()
            folder.chmod(0o777)
        case "readable":
            folder.mkdir()
            folder.chmod(0o755)
        case "link":
            (folder.parent / "elsewhere").mkdir(mode=0o700)
            folder.symlink_to(folder.parent / "elsewhere")
        case "file":
            folder.write_text("")
    return folder


@pytest.mark.usefixtures("place")
@pytest.mark.parametrize(
    ("kind", "words"),
    [
        ("open", r"other users \(mode 777\)"),
        ("readable", r"other users \(mode 755\)"),
        ("link", "is not a folder"),
        ("file", "file exists"),
    ],
)
def test_what_cannot_be_trusted_is_not_used(kind: str, words: str) -> None:
    folder = take_the_name(kind)
    if kind in ("open", "readable"):
        (folder / f"mega-{os.getpid()}").symlink_to("/dev/null")
    assert private_runtime_directories() == []
    assert not any(port.bench for port in ports.find_ports())
    with pytest.raises(UserError, match=f"{folder}.*{words}"):
        make_runtime_directory()


def test_a_folder_of_another_user_is_not_used(place: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    place.mkdir(mode=0o700)
    monkeypatch.setattr(system, "user", lambda: os.geteuid() + 1)
    with pytest.raises(UserError, match="belongs to another user"):
        make_runtime_directory()


def bench(*options: str) -> subprocess.Popen[str]:
    command = [sys.executable, "-m", "greywhale_sim", "--control", *options]
    return subprocess.Popen(command, stdin=subprocess.PIPE, stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True)


@pytest.mark.slow
@pytest.mark.usefixtures("place")
def test_a_bench_runs_unannounced_where_its_folder_is_taken() -> None:
    """The first of several users of a machine must not keep the others from their benches."""
    take_the_name("open")
    with bench() as process:
        assert process.stdout is not None
        port = process.stdout.readline().strip()
        assert Path(port).exists()
        assert not ports.is_bench(port)
        _, said = process.communicate()
    assert process.returncode == 0
    assert "is open to other users (mode 777)" in said
    assert "name its port with --port" in said


@pytest.mark.slow
def test_a_bench_clears_away_what_killed_ones_left(place: Path) -> None:
    with subprocess.Popen(["true"]) as ended:
        ended.wait()
    place.mkdir(mode=0o700)
    left = place / f"mega-{ended.pid}"
    left.symlink_to("/dev/null")
    with bench() as process:
        assert process.stdout is not None
        process.stdout.readline()
        assert not left.is_symlink()
        process.communicate()
    assert list(place.iterdir()) == []
