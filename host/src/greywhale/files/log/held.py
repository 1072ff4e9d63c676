"""Numbers and states as a log holds them: in half the room, from which each comes back to the bit."""

from __future__ import annotations

from typing import Any

import numpy as np
from numpy.typing import NDArray

from greywhale.base.types import Floats
from greywhale.files.log.layout import STATES

_WORDS = np.array(STATES)
_PER_UNIT = 1e6  # a log's numbers have six digits after the point at most


class Packed:
    """Numbers as whole millionths in 32 bits. Indexed as an array is, it makes those numbers that are asked for."""

    def __init__(self, counts: NDArray[np.int32]) -> None:
        self.counts = counts
        self.shape = counts.shape

    def __getitem__(self, key: Any) -> Floats:
        numbers: Floats = self.counts[key] / _PER_UNIT
        return numbers

    def __array__(self, dtype: Any = None, copy: bool | None = None) -> Floats:
        return self[...]

    def max(self) -> float:
        return float(self.counts.max()) / _PER_UNIT

    def min(self) -> float:
        return float(self.counts.min()) / _PER_UNIT


Numbers = Floats | Packed  # either is indexed alike


class Room:
    """Room for numbers that come in blocks: packed, until one comes that would not come back to the bit."""

    def __init__(self, *shape: int) -> None:
        self._values: NDArray[Any] = np.empty(shape, dtype=np.int32)

    def put(self, rows: slice, numbers: Floats) -> None:
        if self._values.dtype == np.int32:
            counts = np.rint(numbers * _PER_UNIT).astype(np.int32)
            # As bits, because a 0 below zero is equal to 0.
            if np.array_equal((counts / _PER_UNIT).view(np.int64), np.ascontiguousarray(numbers).view(np.int64)):
                self._values[rows] = counts
                return
            self._values = self._values / _PER_UNIT
        self._values[rows] = numbers

    def taken(self, rows: int) -> Numbers:
        """The first rows."""
        values = self._values[:rows]
        return Packed(values) if values.dtype == np.int32 else values


def part_of(values: Numbers, rows: Any) -> Numbers:
    """These rows alone, held as all are."""
    return Packed(values.counts[rows]) if isinstance(values, Packed) else values[rows]


class Quantity:
    """A field of a dataclass for numbers (rows, joints). It is set to an array or packed; read, it is an array, made
    anew where it is packed: `held` gives what there is.
    """

    def __set_name__(self, owner: type, name: str) -> None:
        self._name = name

    def __get__(self, owner: object | None, kind: type | None = None) -> Floats:
        if owner is None:
            raise AttributeError(self._name)  # the field has no default
        numbers: Floats = held(owner, self._name)[...]
        return numbers

    def __set__(self, owner: object, values: Numbers) -> None:
        vars(owner)[self._name] = values


def held(owner: object, quantity: str) -> Numbers:
    """A quantity as it is held. Index it by rows and joints for these numbers alone."""
    numbers: Numbers = vars(owner)[quantity]
    return numbers


class State:
    """A field for a word a row (rows,), set to words or to their places in STATES; the places are what it holds."""

    def __set_name__(self, owner: type, name: str) -> None:
        self._name = name

    def __get__(self, owner: object | None, kind: type | None = None) -> NDArray[np.str_]:
        if owner is None:
            raise AttributeError(self._name)  # the field has no default
        words: NDArray[np.str_] = _WORDS[vars(owner)[self._name]]
        return words

    def __set__(self, owner: object, states: NDArray[np.str_] | NDArray[np.int8]) -> None:
        if states.dtype != np.int8:
            states = (states[:, None] == _WORDS).argmax(axis=1).astype(np.int8)
        vars(owner)[self._name] = states
