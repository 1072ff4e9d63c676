"""PlatformIO in firmware/, with the environment that the set-up decided on: `python -m tools.pio test -e native`."""

from __future__ import annotations

import os
import sys

from tools import ROOT
from tools.setup import platformio, venv


def main() -> None:
    os.chdir(ROOT / "firmware")
    os.execve(venv.PYTHON, [str(venv.PYTHON), "-m", "platformio", *sys.argv[1:]], platformio.full_environment())


if __name__ == "__main__":
    main()
