"""One version: both packages, bench, firmware, citation and change log agree."""

from __future__ import annotations

import re
import tomllib
from importlib import metadata

import pytest
from click.testing import CliRunner

import greywhale
from greywhale.cli.verbs import greywhale as command_line
from tools import ROOT

VERSION = tomllib.loads((ROOT / "pyproject.toml").read_text(encoding="utf-8"))["project"]["version"]
PAPER = tomllib.loads((ROOT / "studies/paper/pyproject.toml").read_text(encoding="utf-8"))["project"]


@pytest.mark.parametrize(
    ("file", "pattern"),
    [
        ("CITATION.cff", r"^version: (.*)"),
        ("CHANGELOG.md", r"^## (\d+\.\d+\.\d+)"),
        ("firmware/lib/app/src/version.h", r"version_major = (\d+), version_minor = (\d+), version_patch = (\d+)"),
    ],
)
def test_each_place_has_the_version_of_the_package(file: str, pattern: str) -> None:
    """Three numbers below 256: the firmware reports three bytes."""
    assert re.fullmatch(r"\d{1,2}\.\d{1,2}\.\d{1,2}", VERSION)
    found = re.search(pattern, (ROOT / file).read_text(encoding="utf-8"), re.MULTILINE)
    assert found is not None
    assert ".".join(found.groups()) == VERSION


def test_the_paper_has_it_and_asks_for_it() -> None:
    """It stands on greywhale's rooms as they are in this very version."""
    assert PAPER["version"] == VERSION
    assert f"greywhale=={VERSION}" in PAPER["dependencies"]


def test_what_is_installed_has_it_too() -> None:
    """If not: the set-up installs it anew."""
    assert greywhale.__version__ == metadata.version("greywhale") == metadata.version("greywhale-paper") == VERSION
    answer = CliRunner().invoke(command_line, ["--version"])
    assert answer.output == f"greywhale, version {VERSION}\n"
