"""Installs the outside references that tests/oracles compares with: rigid-body and fuzzy-logic packages of others."""

from __future__ import annotations

import sys

from tools.setup import debian, stamps, venv
from tools.setup.console import ROOT, SetupError, say

DEBIAN = ("octave", "octave-fuzzy-logic-toolkit")
REQUIREMENTS = ROOT / "tools" / "oracles" / "requirements.txt"


def main() -> int:
    try:
        debian.ensure(DEBIAN)
        wanted = stamps.digest([REQUIREMENTS, venv.REQUIREMENTS])
        if not stamps.is_current("oracles", wanted):
            say("installing the outside references (some hundred megabytes)")
            venv.pip_install("--requirement", REQUIREMENTS, "--constraint", venv.REQUIREMENTS, what="Installing them")
            stamps.set_current("oracles", wanted)
    except SetupError as error:
        print(f"set-up: {error}", file=sys.stderr)
        return 1
    return 0


if __name__ == "__main__":
    sys.exit(main())
