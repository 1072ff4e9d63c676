"""Pins every Python package that the two pyproject.toml files lead to: `make lock` writes requirements.txt."""

from __future__ import annotations

import subprocess
import sys
import tempfile
import tomllib
from pathlib import Path

ROOT = Path(__file__).resolve().parents[1]
OWN = {"greywhale", "greywhale-sim"}
HEADER = "# Every Python package of the project, pinned. Written by `make lock` from the two pyproject.toml files.\n"


def wanted() -> list[str]:
    """What the packages ask for to be built, run, checked and tested."""
    host = tomllib.loads((ROOT / "pyproject.toml").read_text(encoding="utf-8"))
    sim = tomllib.loads((ROOT / "sim/pyproject.toml").read_text(encoding="utf-8"))
    names = host["project"]["dependencies"] + sim["project"]["dependencies"] + host["dependency-groups"]["dev"]
    return sorted(name for name in set(names) if name not in OWN)


def main() -> None:
    with tempfile.TemporaryDirectory() as folder:
        subprocess.run([sys.executable, "-m", "venv", folder], check=True)
        python = str(Path(folder) / "bin/python")
        subprocess.run([python, "-m", "pip", "install", "--quiet", *wanted()], check=True)
        freeze = subprocess.run([python, "-m", "pip", "freeze"], check=True, capture_output=True, text=True)
    (ROOT / "requirements.txt").write_text(HEADER + freeze.stdout, encoding="utf-8")


if __name__ == "__main__":
    main()
