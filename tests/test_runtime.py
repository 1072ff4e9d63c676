"""The folder for what runs now is this user's alone: whatever else lies in its place is not trusted."""

from __future__ import annotations

import os
import subprocess
import sys
import tempfile
from pathlib import Path

import pytest

from greywhale.errors import UserError
from greywhale.protocol import ports
from greywhale.runtime import make_runtime_directory, private_runtime_directory, runtime_directory


@pytest.fixture
def temporary(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    """The temporary folder, which other users can write."""
    tmp_path.chmod(0o1777)
    monkeypatch.setattr(tempfile, "tempdir", str(tmp_path))
    monkeypatch.setenv("TMPDIR", str(tmp_path))
    return tmp_path


def test_the_users_runtime_directory_comes_first(temporary: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    own = temporary / "run"
    own.mkdir(mode=0o700)
    monkeypatch.setenv("XDG_RUNTIME_DIR", str(own))
    assert make_runtime_directory() == own / "greywhale"
    assert (own / "greywhale").stat().st_mode & 0o777 == 0o700


@pytest.mark.parametrize("mode", [0o755, 0o777, 0o710])
def test_a_runtime_directory_that_is_open_is_passed_over(
    temporary: Path, monkeypatch: pytest.MonkeyPatch, mode: int
) -> None:
    (temporary / "run").mkdir()
    (temporary / "run").chmod(mode)
    monkeypatch.setenv("XDG_RUNTIME_DIR", str(temporary / "run"))
    assert runtime_directory() == temporary / f"greywhale-{os.getuid()}"


def take_the_name(kind: str) -> Path:
    """What another user, or a careless one, may put in the folder's place."""
    folder = runtime_directory()
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


@pytest.mark.usefixtures("temporary")
@pytest.mark.parametrize(
    ("kind", "words"),
    [
        ("open", "is open to other users (mode 777)"),
        ("readable", "is open to other users (mode 755)"),
        ("link", "is not a folder"),
        ("file", "file exists"),
    ],
)
def test_what_cannot_be_trusted_is_not_used(kind: str, words: str) -> None:
    folder = take_the_name(kind)
    if kind in ("open", "readable"):
        (folder / f"mega-{os.getpid()}").symlink_to("/dev/null")
    assert private_runtime_directory() is None
    assert ports.find_ports() == [] or not any(port.bench for port in ports.find_ports())
    with pytest.raises(UserError) as caught:
        make_runtime_directory()
    assert str(folder) in caught.value.message
    assert words in caught.value.message


@pytest.mark.usefixtures("temporary")
def test_a_folder_of_another_user_is_not_used(monkeypatch: pytest.MonkeyPatch) -> None:
    folder = runtime_directory()
    folder.mkdir(mode=0o700)
    monkeypatch.setattr(os, "getuid", lambda: os.geteuid() + 1)
    folder.rename(runtime_directory())
    with pytest.raises(UserError, match="belongs to another user"):
        make_runtime_directory()


def bench(*options: str) -> subprocess.Popen[str]:
    command = [sys.executable, "-m", "greywhale_sim", "--control", *options]
    return subprocess.Popen(command, stdin=subprocess.PIPE, stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True)


@pytest.mark.usefixtures("temporary")
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


@pytest.mark.usefixtures("temporary")
def test_a_bench_clears_away_what_killed_ones_left() -> None:
    with bench() as killed:
        assert killed.stdout is not None
        killed.stdout.readline()
        killed.kill()
    left = runtime_directory() / f"mega-{killed.pid}"
    assert left.is_symlink()
    with bench() as process:
        assert process.stdout is not None
        process.stdout.readline()
        assert not left.is_symlink()
        process.communicate()
    assert list(runtime_directory().iterdir()) == []
