"""The arm under an ideal controller, which knows plant and state (host/native/ideal/law.h): for floors of the error."""

from __future__ import annotations

import numpy as np
import numpy.typing as npt

from greywhale import _native

Array = npt.NDArray[np.float64]


def simulate_ideal(
    *,
    leader: Array,
    late: int,
    plant: Array,
    supply: float,
    tunings: Array,
    chased: int,
    direction: npt.NDArray[np.int8],
    until: Array,
    keep: bool,
    threads: int,
) -> tuple[Array, Array]:
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
