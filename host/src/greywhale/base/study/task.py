"""A task, and how a worker does it: alike on every executor, because every worker gets and returns the same bytes."""

from __future__ import annotations

import functools
import json
import os
import pickle
import sys
import traceback
import uuid
from collections.abc import Callable, Mapping
from dataclasses import dataclass, field
from typing import Any

from threadpoolctl import threadpool_limits

from greywhale.base.errors import UserError
from greywhale.base.study.plain import decode, encode
from greywhale.base.study.same import facts, require_same

_MODULE = uuid.uuid4().hex


@dataclass(frozen=True)
class Task:
    """`function(seed=seed, **arguments)`, under a key that no other task of the study has.

    The function is one of a module, so that another process finds it; ValueError if it is not.
    """

    key: str
    function: Callable[..., Any]
    seed: int
    arguments: Mapping[str, Any] = field(default_factory=dict)

    def __post_init__(self) -> None:
        found: Any = sys.modules.get(self.function.__module__)
        for name in self.function.__qualname__.split("."):
            found = getattr(found, name, None)
        if found is not self.function:
            raise ValueError(f"task {self.key!r}: {self.function!r} is not a function of a module")
        encode(self.arguments)

    @property
    def identity(self) -> list[Any]:
        """All that its result depends on, for JSON. (The function's module may be called `__main__`, or not.)"""
        return [self.key, self.function.__qualname__, self.seed, encode(self.arguments)]

    def packed(self) -> bytes:
        """The pickled task for a worker."""
        return pickle.dumps((self.key, self.function, self.seed, encode(self.arguments), _process(), facts()))


class TaskFailed(Exception):
    """A task raised what is no UserError; the message holds the worker's traceback."""


def do(packed: bytes) -> str:
    """In a worker: do a task. What it returned, as JSON."""
    try:
        key, function, seed, arguments, process, wanted = pickle.loads(packed)
    except (ImportError, AttributeError) as error:
        raise UserError(f"a worker cannot import what the study does: {error}; install the same there.") from None
    try:
        if process != _process():  # else `run_study` has set the threads of numpy
            _use_one_thread(function)
            require_same(wanted)
        return json.dumps(encode(function(seed=seed, **decode(arguments))), separators=(",", ":"), allow_nan=False)
    except UserError:
        raise
    except (Exception, SystemExit) as error:
        # Not the error itself: a process that cannot unpickle an exception loses all its workers.
        trace = "".join(traceback.format_exception(error))
        raise TaskFailed(f"task {key!r}: {type(error).__name__}: {error}\n{trace}") from None


def _process() -> str:
    """This process, among all of all machines; a fork has the module's number, too."""
    return f"{_MODULE} {os.getpid()}"


@functools.cache
def _use_one_thread(function: Callable[..., Any]) -> None:
    """Sums in several threads may have other last bits; and the other processors have workers of their own.

    A library can be told once it is loaded, which the import of the function's module has done.
    """
    threadpool_limits(limits=1, user_api="blas")
