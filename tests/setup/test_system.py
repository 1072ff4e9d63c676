"""The set-up says of a system that lacks something: one sentence, with what to do."""

from __future__ import annotations

import ast
import runpy
import shutil
import sys
import sysconfig
from pathlib import Path

import pytest

from tools import ROOT
from tools.setup import system
from tools.setup.console import SetupError
from tools.setup.goal import Goal


@pytest.fixture
def programs(monkeypatch: pytest.MonkeyPatch) -> set[str]:
    """The programs that are on the PATH."""
    found: set[str] = set()
    monkeypatch.setattr(shutil, "which", lambda name: name if name in found else None)
    monkeypatch.delenv("CXX", raising=False)
    return found


@pytest.mark.parametrize("compiler", system.CXX_COMPILERS)
def test_one_cpp_compiler_is_enough(programs: set[str], compiler: str) -> None:
    assert "g++" in system.lacking()
    programs.add(compiler)
    assert "g++" not in system.lacking()


def test_a_compiler_that_cmake_is_told_is_enough(programs: set[str], monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setenv("CXX", "/opt/compiler")
    assert "g++" not in system.lacking()


def test_without_apt_what_is_lacking_is_named(
    programs: set[str], monkeypatch: pytest.MonkeyPatch, tmp_path: Path
) -> None:
    monkeypatch.setattr(sysconfig, "get_paths", lambda: {"include": str(tmp_path)})
    with pytest.raises(SetupError) as error:
        system.step(Goal.RUN, avr_compiler=False)
    assert str(error.value).startswith("This system lacks a C++ compiler (g++ or clang++) and the C headers of /")
    assert str(error.value).endswith("(Python.h): install that, then run the same command again.")


def test_without_apt_a_compiler_is_all_that_running_takes(programs: set[str]) -> None:
    programs.add("clang++")
    system.step(Goal.PAGE, avr_compiler=False)


def test_without_apt_programs_for_checks_are_named_once(programs: set[str]) -> None:
    programs |= {"g++", "clang++", "chromium", "wasm-ld", "clang-tidy"}
    with pytest.raises(SetupError, match="^This system lacks avr-gcc and cppcheck: install that, then"):
        system.step(Goal.ALL, avr_compiler=True)


def test_a_user_without_sudo_is_told_the_command(programs: set[str], monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr("os.geteuid", lambda: 1000)
    with pytest.raises(SetupError, match="no sudo to install them with: run `apt-get install g\\+\\+ lld` as root"):
        system.as_root(["apt-get", "install"], ["g++", "lld"])


def test_an_older_python_is_named_by_itself(monkeypatch: pytest.MonkeyPatch) -> None:
    package = ROOT / "tools" / "setup" / "__init__.py"
    for place in (ROOT / "tools" / "__init__.py", package):
        ast.parse(place.read_text(encoding="utf-8"), feature_version=(3, 6))  # it must get so far
    monkeypatch.setattr(sys, "version_info", (3, 10, 13))
    with pytest.raises(SystemExit, match="greywhale needs Python 3.11 or newer, but /"):
        runpy.run_path(str(package))
