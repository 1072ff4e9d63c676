"""The arm under an ideal controller, which knows plant and state (host/native/ideal/law.h): for floors of the error."""

from __future__ import annotations

import numpy as np
import numpy.typing as npt

from greywhale import _native
from greywhale.base.types import Floats


def simulate_ideal(
    *,
    leader: Floats,
    late: int,
    plant: Floats,
    supply: float,
    tunings: Floats,
    chased: int,
    direction: npt.NDArray[np.int8],
    until: Floats,
    keep: bool,
    threads: int,
) -> tuple[Floats, Floats]:
    """Errors (n, 4) rad² and, with `keep`, angles (n, ticks, 4) rad of one plant (columns,) for tunings (n, 4, 4).

    `leader` (slices, 4) rad, `late` in slices. The joint `chased` (-1: none) runs at full voltage in `direction`
    (ticks,) as far as `until` (ticks,) rad.
    """
    mse, angles = _native.simulate_ideal(
        leader=leader,
        late=late,
        plant=plant,
        supply=supply,
        tunings=tunings,
        chased=chased,
        direction=direction,
        until=until,
        keep=keep,
        threads=threads,
    )
    return mse, angles
