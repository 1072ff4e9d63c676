"""Short names: as short as can be, and no two the same."""

from __future__ import annotations

import pytest

from greywhale.pictures.names import distinct_names


@pytest.mark.parametrize(
    ("files", "names"),
    [
        (["run/before.csv"], ["before"]),
        (["before.csv", "after.csv"], ["before", "after"]),
        (["one/log.csv", "two/log.csv", "two/other.csv"], ["one/log", "two/log", "other"]),
        (["/x/one/run/log.csv", "/x/two/run/log.csv"], ["one/…/log", "two/…/log"]),
        (["log.csv", "log.txt"], ["log.csv", "log.txt"]),
        (["log.csv", "./log.csv"], ["log, 1", "log, 2"]),
        (["x" * 100 + ".csv"], ["x" * 15 + "…" + "x" * 14]),
    ],
)
def test_names_tell_files_apart(files: list[str], names: list[str]) -> None:
    assert distinct_names(files) == names


def test_no_two_names_are_the_same() -> None:
    files = ["a/b/log.csv", "b/log.csv", "log.csv", "log.csv", "b/b/log.csv", "x" * 99 + "1.csv", "x" * 50 + "y1.csv"]
    assert len(set(distinct_names(files))) == len(files)
