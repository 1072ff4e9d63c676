"""Lines of very many samples, drawn with fewer points: a picture has no more than some thousand dots in a row."""

from __future__ import annotations

import numpy as np

from greywhale.base.types import Floats

# A line of more samples is thinned to twice so many points. No screen and no printer has so many dots across a panel.
_LONG, _STRETCHES = 100_000, 10_000


def thin(time: Floats, values: Floats) -> tuple[Floats, Floats]:
    """Times and values of a line that looks alike: of each stretch the lowest and the highest sample, in order."""
    if len(time) <= _LONG:
        return time, values
    size = -(-len(time) // _STRETCHES)
    whole = len(time) // size * size
    stretches = values[:whole].reshape(-1, size)
    begins = np.arange(0, whole, size)
    ends = np.sort(np.stack((begins + stretches.argmin(axis=1), begins + stretches.argmax(axis=1))), axis=0)
    rows = np.concatenate((ends.T.ravel(), np.arange(whole, len(time))))
    return time[rows], values[rows]
