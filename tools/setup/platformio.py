"""Decides where PlatformIO gets its compilers: from its own registry, or from Debian where that is out of reach."""

from __future__ import annotations

import os
import shutil
import urllib.error
import urllib.request
from pathlib import Path

from tools import ROOT
from tools.setup import debian, stamps, venv
from tools.setup.console import run, say

CORE = ROOT / "build" / "platformio"
FINISHED = CORE / "assembled"
REGISTRY = "https://api.registry.platformio.org/v3/packages/platformio/platform/atmelavr"
PATIENCE_S = 4


def registry_answers() -> bool:
    try:
        with urllib.request.urlopen(REGISTRY, timeout=PATIENCE_S) as answer:
            return bool(answer.status == 200)
    except (OSError, urllib.error.URLError, ValueError):
        return False


def environment() -> dict[str, str]:
    """What PlatformIO needs in its environment, without a message to anybody and without waiting for updates."""
    quiet = {"PLATFORMIO_SETTING_ENABLE_TELEMETRY": "no", "PLATFORMIO_DISABLE_UPGRADE_CHECK": "true"}
    core = {"PLATFORMIO_CORE_DIR": str(CORE)} if FINISHED.exists() else {}
    return {**venv.environment(), **quiet, **core}


def full_environment() -> dict[str, str]:
    return {**os.environ, **environment()}


def step(checks: bool) -> None:
    """Assemble the project's own core folder if the registry does not answer; the decision is kept in build/stamps."""
    wanted = stamps.digest(stamps.files_below("tools/setup", "requirements.txt"), *debian.PACKAGES)
    chosen = os.environ.get("GREYWHALE_PLATFORMIO", "")  # "registry" or "debian" decides by hand
    current = stamps.is_current("platformio-registry", wanted) and not FINISHED.exists()
    current |= stamps.is_current("platformio-debian", wanted) and FINISHED.exists()
    if current and not chosen:
        return
    if chosen == "registry" or (chosen != "debian" and registry_answers()):
        shutil.rmtree(CORE, ignore_errors=True)
        stamps.set_current("platformio-registry", wanted)
        return
    say("PlatformIO's registry is out of reach: using Debian's compilers in build/platformio")
    assemble: list[str | Path] = [venv.PYTHON, "-m", "tools.setup.offline_core", CORE]
    run(assemble, what="Assembling PlatformIO's folder", env=venv.environment())
    stamps.set_current("platformio-debian", wanted)
