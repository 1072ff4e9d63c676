"""One version: all packages, bench, firmware, citation and change log agree."""

from __future__ import annotations

import re
import tomllib
from importlib import metadata
from typing import Any

import pytest
from click.testing import CliRunner

import greywhale
from greywhale.cli.verbs import greywhale as command_line
from tools import ROOT

VERSION = tomllib.loads((ROOT / "pyproject.toml").read_text(encoding="utf-8"))["project"]["version"]
BESIDE = [
    tomllib.loads((ROOT / "studies" / name / "pyproject.toml").read_text(encoding="utf-8"))["project"]
    for name in ("paper", "lerobot_robot_greywhale")
]


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


@pytest.mark.parametrize("package", BESIDE, ids=lambda package: str(package["name"]))
def test_the_packages_beside_it_have_it_and_ask_for_it(package: dict[str, Any]) -> None:
    """They stand on greywhale's rooms as they are in this very version."""
    assert package["version"] == VERSION
    assert f"greywhale=={VERSION}" in package["dependencies"]


def test_what_is_installed_has_it_too() -> None:
    """If not: the set-up installs it anew."""
    assert greywhale.__version__ == metadata.version("greywhale") == metadata.version("greywhale-paper") == VERSION
    answer = CliRunner().invoke(command_line, ["--version"])
    assert answer.output == f"greywhale, version {VERSION}\n"
