"""Pins every Python package that the two pyproject.toml files lead to: `make lock` writes requirements.txt.

Every version comes with the digests of its files, for all platforms, so that the set-up installs these files or none.
"""

from __future__ import annotations

import re
import subprocess
import sys
import tempfile
import tomllib
from pathlib import Path

ROOT = Path(__file__).resolve().parents[1]
OWN = {"greywhale", "greywhale-sim"}
HEADER = """\
# Every Python package of the project, pinned with the digests of its files. Written by `make lock` from the two
# pyproject.toml files.
"""
# Nothing of this machine's package index goes into the file.
COMPILE = (
    "--generate-hashes", "--no-annotate", "--no-header", "--strip-extras", "--quiet",
    "--no-emit-index-url", "--no-emit-find-links", "--no-emit-trusted-host",
)  # fmt: skip


def runtime() -> list[str]:
    """What the two packages ask for when they are installed."""
    asked = (_project(file)["dependencies"] for file in ("pyproject.toml", "sim/pyproject.toml"))
    return _foreign([name for names in asked for name in names])


def wanted() -> list[str]:
    """What the packages ask for to be built, run, checked and tested."""
    host = tomllib.loads((ROOT / "pyproject.toml").read_text(encoding="utf-8"))
    extras = [name for names in host["project"]["optional-dependencies"].values() for name in names]
    return _foreign([*runtime(), *extras, *host["dependency-groups"]["dev"]])


def versions() -> list[str]:
    """The pinned packages as name==version, without the digests of their files."""
    lines = (ROOT / "requirements.txt").read_text(encoding="utf-8").splitlines()
    return [line.rstrip(" \\") for line in lines if re.match(r"[\w.-]+==", line)]


def _project(file: str) -> dict[str, list[str]]:
    project: dict[str, list[str]] = tomllib.loads((ROOT / file).read_text(encoding="utf-8"))["project"]
    return project


def _foreign(requirements: list[str]) -> list[str]:
    return sorted(name for name in set(requirements) if re.split(r"[^\w-]", name)[0] not in OWN)


def main() -> None:
    with tempfile.TemporaryDirectory() as folder:
        subprocess.run([sys.executable, "-m", "venv", folder], check=True)
        python, asked, pinned = str(Path(folder) / "bin/python"), Path(folder) / "in", Path(folder) / "out"
        subprocess.run([python, "-m", "pip", "install", "--quiet", "pip-tools"], check=True)
        asked.write_text("\n".join(wanted()) + "\n", encoding="utf-8")
        command = [python, "-m", "piptools", "compile", *COMPILE, "--output-file", str(pinned), str(asked)]
        subprocess.run(command, check=True)
        lines = [line for line in pinned.read_text(encoding="utf-8").splitlines() if line and not line.startswith("#")]
    (ROOT / "requirements.txt").write_text(HEADER + "\n".join(lines) + "\n", encoding="utf-8")


if __name__ == "__main__":
    main()
