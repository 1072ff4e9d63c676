"""Compares white box and model on every log.

They run in the closed loop with the log's own controller, because a model is for that. Where the controller is unknown,
they run over windows under the logged voltages.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from greywhale.arm import ArmParameters
from greywhale.firmware import JOINTS
from greywhale.identify.closed_loop import Loop
from greywhale.identify.data import Prepared
from greywhale.identify.space import Space
from greywhale.identify.windows import WindowResidual
from greywhale.table import ParameterTable

Floats = NDArray[np.float64]
FIT, SECOND, CHANGED = "fit", "validation", "validation, changed controller"


@dataclass(frozen=True)
class Subject:
    """A log on which arms are judged."""

    log: Prepared
    table: ParameterTable | None
    role: str


@dataclass(frozen=True)
class Verdict:
    """Mean squared differences between log and model, rad², per joint."""

    name: str
    role: str
    measure: str
    white_box: tuple[float, ...]
    model: tuple[float, ...]

    @property
    def improvement(self) -> float:
        """1 is perfect, 0 no better than the white box."""
        before = sum(self.white_box)
        return 1.0 - sum(self.model) / before if before > 0.0 else 0.0

    def as_dict(self) -> dict[str, object]:
        return {
            "log": self.name,
            "role": self.role,
            "measure": self.measure,
            "white_box_mse_rad2": list(self.white_box),
            "model_mse_rad2": list(self.model),
            "improvement": self.improvement,
        }


def judge(subject: Subject, arm: ArmParameters, plant: Floats, zero: Floats, joints: Sequence[int]) -> Verdict:
    """Judge both arms on one log; joints that were not identified do not count."""
    white = Space.of(arm, (), ())
    kept = np.isin(np.arange(JOINTS), list(joints))
    if subject.table is not None:
        loop = Loop(subject.log, subject.table, arm)
        before = loop.error(white.base[None])[0]
        after = (loop.with_zero(zero) if zero.any() else loop).error(plant[None])[0]
        measure = "closed loop"
    else:
        windows = WindowResidual([subject.log], arm, range(JOINTS))
        before = windows.mse(white.base, np.zeros(JOINTS))
        after = windows.mse(plant, zero)
        measure = "logged voltages, windows"
    pair = (tuple(float(value) for value in np.where(kept, errors, 0.0)) for errors in (before, after))
    return Verdict(subject.log.log.name, subject.role, measure, *pair)


def warnings_of(verdicts: Sequence[Verdict]) -> list[str]:
    """Sentences for numbers that speak against the model."""
    sentences = []
    for verdict in verdicts:
        if verdict.improvement <= 0.0:
            sentences.append(
                f"{verdict.name} ({verdict.role}): the model is no better than the arm file "
                f"({sum(verdict.model):.3g} against {sum(verdict.white_box):.3g} rad²)."
            )
    usual = [verdict for verdict in verdicts if verdict.role != CHANGED]
    changed = [verdict for verdict in verdicts if verdict.role == CHANGED]
    if (
        len(usual) > 1
        and all(one.improvement > 0.0 for one in usual)
        and any(one.improvement <= 0.0 for one in changed)
    ):
        sentences.append(
            "The model improves on the logs of its own controller but not with a changed one: it has learnt that "
            "controller, not the arm. Do not tune with it; check supply, controller file and directions, record again."
        )
    return sentences
