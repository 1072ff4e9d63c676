"""avr8js, the second simulator of the Nano, as its package-lock pins it, and the Node.js that runs it."""

from __future__ import annotations

import shutil

from tools import ROOT
from tools.setup import stamps, system
from tools.setup.console import run, say

PINNED = [ROOT / "tests/oracles/avr8js" / name for name in ("package.json", "package-lock.json")]
PLACE = ROOT / "build" / "avr8js"


def step() -> None:
    if not (shutil.which("node") and shutil.which("npm")):  # somebody may have a newer Node.js than Debian's
        system.ensure(("nodejs", "npm"))
    wanted = stamps.digest(PINNED)
    if stamps.is_current("avr8js", wanted) and (PLACE / "node_modules" / "avr8js").is_dir():
        return
    say("installing avr8js")
    PLACE.mkdir(parents=True, exist_ok=True)
    for path in PINNED:
        shutil.copy(path, PLACE)
    run(["npm", "ci", "--prefix", str(PLACE), "--no-audit", "--no-fund"], what="Installing avr8js with npm")
    stamps.set_current("avr8js", wanted)
