"""The outside references that run in Node.js, as their package-lock pins them, and Node.js itself: avr8js, the second
simulator of the Nano, and the second reader of MCAP files.
"""

from __future__ import annotations

import shutil

from tools import ROOT
from tools.setup import stamps, system
from tools.setup.console import run, say

FOLDERS = ("avr8js", "mcap")  # in tests/oracles; each goes into one of its name in build


def step() -> None:
    if not (shutil.which("node") and shutil.which("npm")):  # somebody may have a newer Node.js than Debian's
        system.ensure(("nodejs", "npm"))
    for name in FOLDERS:
        _install(name)


def _install(name: str) -> None:
    pinned = [ROOT / "tests" / "oracles" / name / file for file in ("package.json", "package-lock.json")]
    place = ROOT / "build" / name
    wanted = stamps.digest(pinned)
    if stamps.is_current(name, wanted) and (place / "node_modules").is_dir():
        return
    say(f"installing {name} for Node.js")
    place.mkdir(parents=True, exist_ok=True)
    for path in pinned:
        shutil.copy(path, place)
    run(["npm", "ci", "--prefix", str(place), "--no-audit", "--no-fund"], what=f"Installing {name} with npm")
    stamps.set_current(name, wanted)
