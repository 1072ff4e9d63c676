"""The pinned packages: one version of each, with the digests of its files, and everything that the project asks for."""

from __future__ import annotations

import re
from pathlib import Path

import pytest

from tools import lock


def pinned(*files: Path) -> dict[str, list[str]]:
    """Digests by package; without files, of what the project needs itself."""
    found: dict[str, list[str]] = {}
    lines = [
        line
        for file in files or (lock.RUN, lock.PAGE, lock.DOCS, lock.COMPILER, lock.CHECKS)
        for line in file.read_text(encoding="utf-8").splitlines()
    ]
    for line in lines:
        if re.match(r"([\w.-]+)==\S+", line):
            name = lock.name_of(line)
            assert name not in found
            found[name] = []
        elif match := re.match(r"    --hash=sha256:([0-9a-f]{64})", line):
            found[name].append(match[1])
        else:
            assert line.startswith("#"), line
    return found


@pytest.mark.parametrize(
    ("file", "least"),
    [(lock.RUN, 10), (lock.PAGE, 1), (lock.DOCS, 4), (lock.COMPILER, 2), (lock.CHECKS, 10), (lock.ORACLES, 10)],
    ids=["run", "page", "docs", "compiler", "checks", "oracles"],
)
def test_every_package_has_digests(file: Path, least: int) -> None:
    assert len(pinned(file)) >= least
    assert all(pinned(file).values())


def test_the_outside_references_come_beside_the_projects_own_packages() -> None:
    references = pinned(lock.ORACLES)
    assert set(lock.REFERENCES) <= set(references)
    assert not set(references) & set(pinned())


def test_all_that_is_asked_for_is_pinned() -> None:
    files_of = {"page": [lock.PAGE], "docs": [lock.RUN, lock.DOCS], "compiler": [lock.COMPILER]}
    groups = [(lock.group(name), files) for name, files in files_of.items()]
    for asked, files in ((lock.build(), [lock.RUN]), *groups, (lock.wanted(), [])):
        assert {lock.name_of(name) for name in asked} - set(pinned(*files)) == set()
