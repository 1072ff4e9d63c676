"""Decides where PlatformIO gets its compiler: from its own registry, or where that is out of reach from PyPI, which has
the same avr-gcc for most machines, or else from the system.
"""

from __future__ import annotations

import os
import platform
import shutil
import sys
import urllib.error
import urllib.request
from pathlib import Path

from tools import AVR_TOOLS, ROOT
from tools.setup import stamps, venv
from tools.setup.console import SetupError, run, say

SOURCES = ("registry", "pypi", "system")
BY_HAND = "GREYWHALE_PLATFORMIO"  # this variable of the environment names one of them
CORE = ROOT / "build" / "platformio"
SYSTEM_CORE = ROOT / "build" / "platformio-system"  # the second compiler's, for checks
FINISHED = "assembled"  # this file says that a core folder is whole
REGISTRY = "https://api.registry.platformio.org/v3/packages/platformio/platform/atmelavr"
PATIENCE_S = 4


def registry_answers() -> bool:
    try:
        with urllib.request.urlopen(REGISTRY, timeout=PATIENCE_S) as answer:
            return bool(answer.status == 200)
    except (OSError, urllib.error.URLError, ValueError):
        return False


def pypi_has_compiler() -> bool:
    """True if tools/setup/compiler.txt has a wheel for this machine."""
    return sys.platform != "linux" or (platform.machine() == "x86_64" and platform.libc_ver()[0] == "glibc")


def _inputs() -> str:
    return stamps.digest(stamps.files_below("tools/setup", "requirements.txt"))


def choose() -> str:
    """The source of the compiler; once made, the choice stays until the set-up changes."""
    wanted = os.environ.get(BY_HAND, "")
    if wanted and wanted not in SOURCES:
        raise SetupError(f"{BY_HAND} is {wanted!r}: it can be {', '.join(SOURCES)}.")
    if wanted:
        return wanted
    for source in SOURCES:
        if stamps.is_current(f"platformio-{source}", _inputs()):
            return source
    return "registry" if registry_answers() else "pypi" if pypi_has_compiler() else "system"


def environment(core: Path = CORE) -> dict[str, str]:
    """PlatformIO's environment, in which it sends no message to anybody and waits for no updates."""
    quiet = {"PLATFORMIO_SETTING_ENABLE_TELEMETRY": "no", "PLATFORMIO_DISABLE_UPGRADE_CHECK": "true"}
    own = {"PLATFORMIO_CORE_DIR": str(core)} if (core / FINISHED).exists() else {}
    return {**venv.environment(), **quiet, **own}


def full_environment() -> dict[str, str]:
    return {**os.environ, **environment()}


def assemble(core: Path, source: str) -> None:
    command: list[str | Path] = [venv.PYTHON, "-m", "tools.setup.offline_core", core, source]
    run(command, what="Assembling PlatformIO's folder", env=venv.environment())


def step(source: str) -> None:
    """Assemble the project's own core folder, but for the registry; only one source is current at a time."""
    if stamps.is_current(f"platformio-{source}", _inputs()) and (source == "registry") != (CORE / FINISHED).exists():
        return
    for other in SOURCES:
        stamps.forget(f"platformio-{other}")
    if source == "registry":
        shutil.rmtree(CORE, ignore_errors=True)
    else:
        where = {"pypi": "the avr-gcc 7.3.0 of PyPI", "system": "the system's avr-gcc"}[source]
        say(f"PlatformIO's registry is out of reach: using {where} in build/platformio")
        assemble(CORE, source)
    stamps.set_current(f"platformio-{source}", _inputs())


def link_tools() -> None:
    """Let AVR_TOOLS be the compiler's folder. From the registry it comes with the first build."""
    home = Path(os.environ.get("PLATFORMIO_CORE_DIR") or Path.home() / ".platformio")
    core = CORE if (CORE / FINISHED).exists() else home
    place = AVR_TOOLS.parent
    fresh = place.with_name("avr.new")
    fresh.unlink(missing_ok=True)
    fresh.symlink_to(core / "packages" / "toolchain-atmelavr")
    fresh.replace(place)
