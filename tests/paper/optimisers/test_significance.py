"""Differences between optimisers are told apart from chance, and only from chance."""

from __future__ import annotations

import numpy as np
import pytest

from greywhale_paper.optimisers.significance import against, against_each, fewest, holm, mean_ranks


def test_holm_multiplies_by_what_is_left_and_never_falls() -> None:
    assert holm([0.01, 0.04, 0.03]) == pytest.approx([0.03, 0.06, 0.06])
    assert holm([0.5, 0.9]) == pytest.approx([1.0, 1.0])


def test_clear_differences_are_told_in_both_directions() -> None:
    random = np.random.default_rng(1)
    costs = {name: (level + 0.1 * random.random(10)).tolist() for name, level in (("a", 2.0), ("b", 1.0), ("c", 3.0))}
    found = against(costs, "a")
    assert (found["b"].word, found["c"].word) == ("higher", "lower")
    assert max(one.chance for one in found.values()) < 0.01


def test_the_same_costs_are_not_told_apart() -> None:
    costs = {"a": [1.0, 2.0, 3.0], "b": [3.0, 1.0, 2.0]}
    assert against(costs, "a")["b"].word == "not told apart"


def test_more_questions_make_each_answer_less_sure() -> None:
    costs = {"a": [1.0, 2.0, 3.0, 4.0, 5.0], "b": [6.0, 7.0, 8.0, 9.0, 10.0]}
    alone, among = against(costs, "a")["b"], against_each({str(n): costs for n in range(8)}, "a")
    assert alone.word == "lower"
    assert alone.chance == pytest.approx(2 / 252)
    assert {one["b"].word for one in among.values()} == {"not told apart"}
    assert among["0"]["b"].chance == pytest.approx(8 * alone.chance)


def test_ranks_are_means_over_runs_with_ties_shared() -> None:
    assert mean_ranks({"a": [1.0, 5.0], "b": [2.0, 5.0], "c": [3.0, 1.0]}) == {"a": 1.75, "b": 2.25, "c": 2.0}


@pytest.mark.parametrize("questions", [1, 3, 6, 8])
def test_with_fewer_runs_than_the_fewest_no_pair_is_told_apart_however_far(questions: int) -> None:
    def words(runs: int) -> set[str]:
        costs = {"own": [float(run) for run in range(runs)]}
        costs |= {f"rival {number}": [1000.0 + number + run for run in range(runs)] for number in range(questions)}
        return {one.word for one in against(costs, "own").values()}

    assert words(fewest(questions)) == {"lower"}
    assert words(fewest(questions) - 1) == {"not told apart"}
