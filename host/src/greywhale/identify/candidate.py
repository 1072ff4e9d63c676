"""A model in the making, and what its error is measured by: windows, or windows and closed loop together."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, replace

import numpy as np

from greywhale.base.types import Floats
from greywhale.identify.closed_loop import LoopResidual
from greywhale.identify.space import Space
from greywhale.identify.windows import WindowResidual


@dataclass(frozen=True)
class Candidate:
    """A model in the making. `held_out` is its error on windows to which it was not fitted, None before that is
    measured.
    """

    space: Space
    x: Floats
    order: str
    held_out: float | None = None
    closed: bool = False  # fitted to the closed loop too
    knocking: tuple[int, ...] = ()  # joints whose gears are fitted to short windows

    @property
    def kinds(self) -> tuple[str, ...]:
        """The kinds of its searched numbers, each once."""
        return tuple(dict.fromkeys(parameter.kind for parameter in self.space.parameters))

    @property
    def plant(self) -> Floats:
        found: Floats = self.space.plants(self.x[None])[0]
        return found

    @property
    def zero(self) -> Floats:
        found: Floats = self.space.offsets(self.x[None])[0]
        return found

    def with_values(self, values: Mapping[str, float]) -> Candidate:
        """Return the model with some kinds of quantities at other values, on every joint."""
        x = self.x.copy()
        for index, one in enumerate(self.space.parameters):
            if one.kind in values:
                x[index] = self.space.kind(index).to_search(values[one.kind])
        return replace(self, x=x)


class WindowsAndLoop:
    """Windows and closed loop in one residual, each in standard deviations of the error that the model cannot avoid."""

    def __init__(self, windows: WindowResidual, loops: LoopResidual, candidate: Candidate) -> None:
        self._windows = windows
        self._loops = loops
        self.joint_of = np.concatenate([windows.joint_of, loops.joint_of])
        self.seconds = windows.seconds + loops.seconds
        # An error that the model cannot explain in the windows is no noise of single readings, but it weighs like
        # noise.
        missed = windows(candidate.space, candidate.x[None])
        self._scale = max(1.0, float(np.sqrt(np.mean(missed**2))))

    def __call__(self, space: Space, points: Floats) -> Floats:
        parts = (
            self._windows(space, points) / self._scale,
            self._loops(space, points) / self._windows.limits.windows.loop_doubt_rad,
        )
        return np.concatenate(parts, axis=1)
