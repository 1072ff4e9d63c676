"""The packages that the operating system must bring, and their installation by apt, or a list of those that lack."""

from __future__ import annotations

import os
import shutil
import subprocess
import sys
import sysconfig
from collections.abc import Sequence
from pathlib import Path

from tools.setup.console import SetupError, run, say
from tools.setup.goal import Goal

CXX_COMPILERS = ("c++", "g++", "clang++")  # as CMake looks for them
FOR_CHECKS = (
    "gcc-avr",  # the firmware by Debian's compiler, beside the one that PlatformIO installs
    "avr-libc",
    "binutils-avr",
    "doctest-dev",  # unit tests of the firmware
    "cppcheck",
    "clang-tidy",
    "libclang-rt-dev",  # libFuzzer and the sanitizers, over the firmware
    "chromium",  # the page, in a real browser
)
FOR_PAGE = (
    "clang",  # what runs inside a page: compiler, linker, C and C++ libraries for WebAssembly
    "lld",
    "libc++-dev-wasm32",
    "libclang-rt-dev-wasm32",
)
AVR_COMPILER = ("gcc-avr", "avr-libc", "binutils-avr")
# Of these, programs by which a system without Debian's packages can be asked.
PROGRAMS_FOR_CHECKS = ("avr-gcc", "cppcheck", "clang-tidy", "chromium")
PROGRAMS_FOR_PAGE = ("clang++", "wasm-ld")


def cxx_compiler() -> str | None:
    """The C++ compiler that is there."""
    return os.environ.get("CXX") or next(filter(None, map(shutil.which, CXX_COMPILERS)), None)


def lacking() -> dict[str, str]:
    """Each thing that every set-up needs and is not here, whoever installs it: Debian's package, and its name."""
    found = {}
    if cxx_compiler() is None:
        found["g++"] = "a C++ compiler (g++ or clang++)"
    try:
        import ensurepip  # noqa: F401
    except ModuleNotFoundError:
        found["python3-venv"] = f"the module venv of {sys.executable}"
    if not (Path(sysconfig.get_paths()["include"]) / "Python.h").is_file():
        found["python3-dev"] = f"the C headers of {sys.executable} (Python.h)"
    return found


def has_apt() -> bool:
    return all(map(shutil.which, ("dpkg-query", "apt-get")))


def installed(packages: Sequence[str]) -> set[str]:
    """Those of the packages that dpkg has, whole."""
    query = ["dpkg-query", "--show", "--showformat=${Package} ${db:Status-Status}\\n", *packages]
    lines = subprocess.run(query, capture_output=True, text=True, check=False).stdout.splitlines()
    return {line.split()[0] for line in lines if line.endswith(" installed")}


def as_root(command: Sequence[str], missing: Sequence[str]) -> list[str]:
    """The command for somebody who may install packages, with sudo where needed and possible."""
    if os.geteuid() == 0:
        return list(command)
    by_hand = f"run `apt-get install {' '.join(missing)}` as root, then the same command again."
    if shutil.which("sudo") is None:
        raise SetupError(f"Debian packages are missing and there is no sudo to install them with: {by_hand}")
    if subprocess.run(["sudo", "-v"], check=False).returncode != 0:
        raise SetupError(f"Debian packages are missing and sudo does not let you install them: {by_hand}")
    return ["sudo", *command]


def ensure(packages: Sequence[str]) -> None:
    """Install those Debian packages that are missing."""
    if not has_apt():
        raise SetupError(f"There is no apt here to install {' '.join(packages)} with: install their like by hand.")
    present = installed(packages)
    missing = [package for package in packages if package not in present]
    if not missing:
        return
    say(f"installing Debian packages: {' '.join(missing)} (up to a minute)")
    quiet = {"DEBIAN_FRONTEND": "noninteractive"}
    install = ["apt-get", "install", "--yes", "--no-install-recommends", *missing]
    run(as_root(["apt-get", "update"], missing), what="apt-get update", env=quiet)
    run(as_root(install, missing), what=f"Installing {' '.join(missing)} with apt-get", env=quiet)


def _need(names: Sequence[str]) -> None:
    if names:
        words = f"{', '.join(names[:-1])} and {names[-1]}" if len(names) > 1 else names[0]
        raise SetupError(f"This system lacks {words}: install that, then run the same command again.")


def step(goal: Goal, avr_compiler: bool) -> None:
    """Install what is lacking, or say what; `avr_compiler`: the firmware is built by the system's own avr-gcc.

    Elsewhere than on Debian the dashboard's page may be built without what FOR_PAGE is for.
    """

    def wanted(compiler: Sequence[str], page: Sequence[str], checks: Sequence[str]) -> list[str]:
        asked = ((compiler, avr_compiler), (page, goal >= Goal.PAGE), (checks, goal >= Goal.ALL))
        return [name for names, are_wanted in asked if are_wanted for name in names]

    if has_apt():
        ensure((*lacking(), *wanted(AVR_COMPILER, FOR_PAGE, FOR_CHECKS)))
        _need(list(lacking().values()))  # a Python that is not Debian's has its headers elsewhere
        return
    programs = wanted(("avr-gcc",), PROGRAMS_FOR_PAGE if goal >= Goal.SITE else (), PROGRAMS_FOR_CHECKS)
    _need([*lacking().values(), *(name for name in dict.fromkeys(programs) if shutil.which(name) is None)])
