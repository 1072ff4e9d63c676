"""Tasks and plain values: what cannot go to another process or into a file is refused where the task is made."""

from __future__ import annotations

import pickle
from typing import Any

import numpy as np
import pytest

from greywhale.base.errors import UserError
from greywhale.base.study import Task
from greywhale.base.study.plain import decode, encode
from greywhale.base.study.task import do
from tests.base.study import jobs


@pytest.mark.parametrize(
    "value",
    [
        None,
        True,
        -(10**40),
        "ä\x00\u2028",
        [1, [2.5, "x"], {}],
        {"a": {"b": []}, "": None},
        np.arange(6, dtype=np.int16).reshape(2, 3),
        np.array([[np.nan, -np.inf, -0.0]]),
        np.array([], dtype=bool),
        np.array(1 + 2j),
        np.asfortranarray(np.arange(6.0).reshape(2, 3)),
        np.arange(3, dtype=">f8"),
    ],
)
def test_plain_values_come_back(value: Any) -> None:
    back = decode(encode(value))
    np.testing.assert_equal(back, value)
    assert type(back) is type(value)


def test_numbers_of_numpy_and_tuples_become_pythons_own() -> None:
    back = decode(encode((np.float64(0.1), np.int8(3), np.bool_(True), np.float32(0.5))))
    assert back == [0.1, 3, True, 0.5]
    assert [type(one) for one in back] == [float, int, bool, float]


@pytest.mark.parametrize(
    "value", [object(), {1: 2}, {"$float": "x"}, {"$array": 1}, b"x", {1}, np.array(["x"]), np.array([None])]
)
def test_what_is_not_plain_is_refused(value: Any) -> None:
    with pytest.raises((TypeError, ValueError)):
        Task("x", jobs.draw, 0, {"count": value})


def test_functions_that_no_other_process_finds_are_refused() -> None:
    def inner(seed: int) -> int:
        return seed

    for function in (inner, lambda seed: seed):
        with pytest.raises(ValueError, match="task 'x': .* is not a function of a module"):
            Task("x", function, 0)


@pytest.mark.parametrize("name", ["greywhale", "Python", "numpy", "scipy"])
def test_a_worker_with_another_version_refuses(name: str) -> None:
    *what, _, wanted = pickle.loads(Task("x", jobs.draw, 0, {"count": 3}).packed())
    assert do(pickle.dumps((*what, "another process", wanted)))
    sentence = rf"^a worker has {name} \S+, but this study needs 9\.9; install the same there\."
    with pytest.raises(UserError, match=sentence):
        do(pickle.dumps((*what, "another process", wanted | {name: "9.9"})))


def test_a_worker_that_rounds_otherwise_refuses() -> None:
    *what, _, wanted = pickle.loads(Task("x", jobs.draw, 0, {"count": 3}).packed())
    with pytest.raises(
        UserError, match="^a worker's processor or C library rounds otherwise than this machine's; start"
    ):
        do(pickle.dumps((*what, "another process", wanted | {"rounding": "0"})))
