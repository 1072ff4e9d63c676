"""Pins every Python package that the two pyproject.toml files lead to: `make lock` writes requirements.txt."""

from __future__ import annotations

import re
import subprocess
import sys
import tempfile
import tomllib
from pathlib import Path

ROOT = Path(__file__).resolve().parents[1]
OWN = {"greywhale", "greywhale-sim"}
HEADER = "# Every Python package of the project, pinned. Written by `make lock` from the two pyproject.toml files.\n"


def runtime() -> list[str]:
    """What the two packages ask for when they are installed."""
    asked = (_project(file)["dependencies"] for file in ("pyproject.toml", "sim/pyproject.toml"))
    return _foreign([name for names in asked for name in names])


def wanted() -> list[str]:
    """What the packages ask for to be built, run, checked and tested."""
    host = tomllib.loads((ROOT / "pyproject.toml").read_text(encoding="utf-8"))
    extras = [name for names in host["project"]["optional-dependencies"].values() for name in names]
    return _foreign([*runtime(), *extras, *host["dependency-groups"]["dev"]])


def _project(file: str) -> dict[str, list[str]]:
    project: dict[str, list[str]] = tomllib.loads((ROOT / file).read_text(encoding="utf-8"))["project"]
    return project


def _foreign(requirements: list[str]) -> list[str]:
    return sorted(name for name in set(requirements) if re.split(r"[^\w-]", name)[0] not in OWN)


def main() -> None:
    with tempfile.TemporaryDirectory() as folder:
        subprocess.run([sys.executable, "-m", "venv", folder], check=True)
        python = str(Path(folder) / "bin/python")
        subprocess.run([python, "-m", "pip", "install", "--quiet", *wanted()], check=True)
        freeze = subprocess.run([python, "-m", "pip", "freeze"], check=True, capture_output=True, text=True)
    (ROOT / "requirements.txt").write_text(HEADER + freeze.stdout, encoding="utf-8")


if __name__ == "__main__":
    main()
