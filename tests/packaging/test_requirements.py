"""The pinned packages: one version of each, with the digests of its files, and everything that the project asks for."""

from __future__ import annotations

import re
import subprocess
import sys
from pathlib import Path

from tools import lock
from tools.setup.venv import REQUIREMENTS


def normal(name: str) -> str:
    return re.sub(r"[-_.]+", "-", name).lower()


def pinned() -> dict[str, list[str]]:
    """Digests by package and version."""
    found: dict[str, list[str]] = {}
    for line in REQUIREMENTS.read_text(encoding="utf-8").splitlines():
        if match := re.match(r"([\w.-]+)==\S+", line):
            name = normal(match[1])
            assert name not in found
            found[name] = []
        elif match := re.match(r"    --hash=sha256:([0-9a-f]{64})", line):
            found[name].append(match[1])
        else:
            assert line.startswith("#"), line
    return found


def test_every_package_has_digests() -> None:
    assert all(pinned().values())


def test_versions_alone_can_be_had_too() -> None:
    """For a constraint: with digests, pip takes nothing else that is not pinned on the command line."""
    versions = lock.versions()
    assert {normal(line.partition("==")[0]) for line in versions} == set(pinned())
    assert all(re.fullmatch(r"[\w.-]+==[\w.!+-]+", line) for line in versions)


def test_all_that_is_asked_for_is_pinned() -> None:
    asked = {normal(re.split(r"[^\w.-]", name)[0]) for name in lock.wanted()}
    assert asked - set(pinned()) == set()


def test_another_file_is_refused(tmp_path: Path) -> None:
    """As pip does it with the options of the set-up; nothing is fetched for it."""
    (tmp_path / "one-1.0-py3-none-any.whl").write_bytes(b"another file")
    (tmp_path / "in").write_text(f"one==1.0 --hash=sha256:{'0' * 64}\n")
    options = ["--no-index", "--find-links", str(tmp_path), "--require-hashes", "--no-deps", "--dry-run"]
    command = [sys.executable, "-m", "pip", "install", *options, "--requirement", str(tmp_path / "in")]
    done = subprocess.run(command, capture_output=True, text=True, check=False)
    assert done.returncode != 0
    assert "THESE PACKAGES DO NOT MATCH THE HASHES" in done.stderr
