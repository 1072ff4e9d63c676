"""What a request asks for, and what it refuses."""

from __future__ import annotations

from pathlib import Path

import pytest

from greywhale.base.errors import UserError
from greywhale.reproduce.request import Request
from greywhale.reproduce.run import results_file
from greywhale.reproduce.tasks import tasks_of


def test_every_piece_of_work_has_a_key_of_its_own() -> None:
    keys = [task.key for task in tasks_of(Request.of(0, None, False))]
    assert len(keys) == len(set(keys))


def test_a_quick_request_asks_for_the_same_kinds_of_work() -> None:
    def kinds(quick: bool) -> set[str]:
        return {task.function.__qualname__ for task in tasks_of(Request.of(0, None, quick))}

    assert kinds(True) == kinds(False)
    assert len(tasks_of(Request.of(0, None, True))) < len(tasks_of(Request.of(0, None, False)))


def test_seeds_count_from_the_first() -> None:
    request = Request.of(7, 4, False)
    assert request.every_seed == (7, 8, 9, 10)
    assert request.few_seeds == (7, 8, 9)


def test_another_request_has_another_results_file() -> None:
    folder = Path("out")
    files = {results_file(Request.of(seed, 3, quick), folder) for seed in (0, 1) for quick in (False, True)}
    assert len(files) == 4


@pytest.mark.parametrize(("seed", "seeds"), [(-1, 3), (0, 0), (0, 1001)])
def test_what_makes_no_sense_is_refused(seed: int, seeds: int) -> None:
    with pytest.raises(UserError, match="it must be"):
        Request.of(seed, seeds, True)
