"""What greywhale and greywhale-sim depend on, as wheels in build/wheelhouse: for installations in a test."""

from __future__ import annotations

import shutil

from tools import ROOT, lock
from tools.setup import stamps, venv
from tools.setup.console import run, say

WHEELHOUSE = ROOT / "build" / "wheelhouse"
VERSIONS = ROOT / "build" / "versions.txt"


def step() -> None:
    needed = lock.runtime()
    wanted = stamps.digest([venv.REQUIREMENTS], *needed)
    if stamps.is_current("wheelhouse", wanted) and WHEELHOUSE.is_dir():
        return
    say("fetching what the packages depend on, for installations without a network")
    shutil.rmtree(WHEELHOUSE, ignore_errors=True)
    pip = [str(venv.PYTHON), "-m", "pip", "wheel", "--quiet", "--disable-pip-version-check", "--no-input"]
    # Where a file has digests, pip takes nothing that is not pinned on the command line; versions alone will do.
    VERSIONS.write_text("\n".join(lock.versions()) + "\n", encoding="utf-8")
    constraint = ["--constraint", str(VERSIONS), "--wheel-dir", str(WHEELHOUSE)]
    run([*pip, *constraint, *needed], what="Fetching wheels", env=venv.environment())
    stamps.set_current("wheelhouse", wanted)
