"""Asks the rules of a calibration in C++, which the page asks too: calibrate/rules.h says what each takes."""

from __future__ import annotations

import numpy as np
from numpy.typing import ArrayLike

from greywhale import _native
from greywhale.base.types import Floats

MARGIN_RAD = _native.CALIBRATION_MARGIN_RAD  # kept from both ends of what the person showed
PULSE_SHARES = _native.PULSE_SHARES  # of the supply, tried one after the other


def ask(rule: str, *given: ArrayLike) -> tuple[Floats, str]:
    """The numbers that a rule answers to these, and its words: what is wrong, or what a person is told."""
    parts = [np.ravel(np.asarray(one, dtype=np.float64)) for one in given]
    return _native.calibration_rule(rule, np.concatenate([*parts, np.empty(0)]))


def words(rule: str, *given: ArrayLike) -> str:
    """The words of a rule that has no numbers."""
    return ask(rule, *given)[1]
