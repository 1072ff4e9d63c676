"""The Debian packages this project needs, and how they get installed."""

from __future__ import annotations

import os
import shutil
import subprocess
import sysconfig
from collections.abc import Sequence
from pathlib import Path

from tools.setup.console import SetupError, run, say

PACKAGES = (
    "gcc-avr",  # the firmware: compiler, C library, Arduino core
    "binutils-avr",
    "avr-libc",
    "arduino-core-avr",
    "g++",  # native extensions
)
FOR_CHECKS = (
    "doctest-dev",  # unit tests of the firmware
    "cppcheck",
    "clang-tidy",
    "clang",  # libFuzzer and the sanitizers, over the firmware
    "libclang-rt-dev",
    "chromium",  # the page, in a real browser
    "lld",  # the bench inside a page: linker, C and C++ libraries for WebAssembly
    "libc++-dev-wasm32",
    "libclang-rt-dev-wasm32",
)


def python_packages() -> tuple[str, ...]:
    """What Debian's own Python lacks for a .venv with extension modules; other Pythons bring these along."""
    try:
        import ensurepip  # noqa: F401

        venv: tuple[str, ...] = ()
    except ModuleNotFoundError:
        venv = ("python3-venv",)
    header = Path(sysconfig.get_paths()["include"]) / "Python.h"
    return venv if header.is_file() else (*venv, "python3-dev")


def installed(packages: Sequence[str]) -> set[str]:
    """Those of the packages that dpkg has, whole."""
    query = ["dpkg-query", "--show", "--showformat=${Package} ${db:Status-Status}\\n", *packages]
    lines = subprocess.run(query, capture_output=True, text=True, check=False).stdout.splitlines()
    return {line.split()[0] for line in lines if line.endswith(" installed")}


def as_root(command: Sequence[str], missing: Sequence[str]) -> list[str]:
    """The command for somebody who may install packages, with sudo where needed and possible."""
    if os.geteuid() == 0:
        return list(command)
    by_hand = f"run `apt-get install {' '.join(missing)}` as root, then try again."
    if shutil.which("sudo") is None:
        raise SetupError(f"Debian packages are missing and there is no sudo to install them with: {by_hand}")
    if subprocess.run(["sudo", "-v"], check=False).returncode != 0:
        raise SetupError(f"Debian packages are missing and sudo does not let you install them: {by_hand}")
    return ["sudo", *command]


def ensure(packages: Sequence[str]) -> None:
    """Install those packages that are missing."""
    if shutil.which("dpkg-query") is None:
        raise SetupError(
            f"This is not a Debian system: install the equivalents of {' '.join(packages)} yourself, "
            "then run the set-up with GREYWHALE_SKIP_APT=1."
        )
    present = installed(packages)
    missing = [package for package in packages if package not in present]
    if not missing:
        return
    say(f"installing Debian packages: {' '.join(missing)}")
    quiet = {"DEBIAN_FRONTEND": "noninteractive"}
    install = ["apt-get", "install", "--yes", "--no-install-recommends", *missing]
    run(as_root(["apt-get", "update"], missing), what="apt-get update", env=quiet)
    run(as_root(install, missing), what=f"Installing {' '.join(missing)} with apt-get", env=quiet)


def step(checks: bool) -> None:
    if os.environ.get("GREYWHALE_SKIP_APT"):
        return
    ensure((*python_packages(), *PACKAGES, *(FOR_CHECKS if checks else ())))
