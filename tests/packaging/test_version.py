"""One version: package, bench, firmware, citation and change log agree, and are changed together."""

from __future__ import annotations

import re
import shutil
import tomllib
from importlib import metadata
from pathlib import Path

import pytest
from click.testing import CliRunner

import greywhale
from greywhale.cli.verbs import greywhale as command_line
from tools import ROOT
from tools.generate import version


@pytest.fixture
def copy(tmp_path: Path) -> Path:
    """The files that hold a version."""
    for name in {version.SOURCE, *(place.file for place in version.COPIES)}:
        (tmp_path / name).parent.mkdir(parents=True, exist_ok=True)
        shutil.copy(ROOT / name, tmp_path / name)
    return tmp_path


def test_all_versions_agree() -> None:
    assert version.stale_files(ROOT) == []
    project = tomllib.loads((ROOT / "pyproject.toml").read_text())["project"]
    bench = tomllib.loads((ROOT / "sim/pyproject.toml").read_text())["project"]
    assert bench["version"] == project["version"]
    assert f"greywhale=={project['version']}" in bench["dependencies"]
    assert f"\nversion: {project['version']}\n" in (ROOT / "CITATION.cff").read_text()
    assert re.search(rf"^## {re.escape(project['version'])}\b", (ROOT / "CHANGELOG.md").read_text(), re.M)
    assert greywhale.__version__ == project["version"]
    assert metadata.version("greywhale-sim") == project["version"]
    answer = CliRunner().invoke(command_line, ["--version"])
    assert answer.output == f"greywhale, version {project['version']}\n"


def test_a_new_version_reaches_every_place(copy: Path) -> None:
    assert version.main(["--root", str(copy), "10.20.30"]) == 0
    assert version.read_version(copy) == "10.20.30"
    header = (copy / "firmware/lib/app/src/version.h").read_text()
    assert "version_major = 10, version_minor = 20, version_patch = 30;" in header
    bench = tomllib.loads((copy / "sim/pyproject.toml").read_text())["project"]
    assert bench["version"] == "10.20.30"
    assert "greywhale==10.20.30" in bench["dependencies"]
    assert "\nversion: 10.20.30\n" in (copy / "CITATION.cff").read_text()
    assert "\ncff-version: 1.2.0\n" in "\n" + (copy / "CITATION.cff").read_text()


@pytest.mark.parametrize("file", sorted({place.file for place in version.COPIES}))
def test_a_place_that_was_forgotten_is_named(copy: Path, file: str, capsys: pytest.CaptureFixture[str]) -> None:
    text = (copy / file).read_text()
    (copy / file).write_text(version.updated_texts(copy, "99.98.97")[file])
    assert version.main(["--root", str(copy), "--check"]) == 1
    assert capsys.readouterr().err.startswith(f"{file} has another version than pyproject.toml")
    assert version.main(["--root", str(copy)]) == 0
    assert (copy / file).read_text() == text


@pytest.mark.parametrize("wrong", ["1.0", "1.0.0rc1", "v1.0.0", "1000.0.0"])
def test_a_version_that_the_firmware_cannot_report_is_refused(
    copy: Path, wrong: str, capsys: pytest.CaptureFixture[str]
) -> None:
    assert version.main(["--root", str(copy), wrong]) == 1
    assert "three numbers" in capsys.readouterr().err
    assert version.stale_files(copy) == []


def test_a_place_that_is_gone_is_named(copy: Path, capsys: pytest.CaptureFixture[str]) -> None:
    (copy / "CITATION.cff").write_text("cff-version: 1.2.0\n")
    assert version.main(["--root", str(copy), "--check"]) == 1
    assert capsys.readouterr().err.startswith("CITATION.cff: 0 places match")
