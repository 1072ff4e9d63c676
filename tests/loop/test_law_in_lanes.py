"""The law in sixteen lanes gives the firmware's own voltages, bit for bit, on every instruction set of this machine."""

from __future__ import annotations

from typing import Any

import numpy as np
import numpy.typing as npt
import pytest

from greywhale import _native
from greywhale.loop import CONTROLLER_COLUMNS

LANES = 16
STEPS = 4000


def random_controllers(random: np.random.Generator, period_ms: int) -> npt.NDArray[np.int32]:
    """Anything the firmware takes, log-uniform, with the extremes: short and long ramps, no gain, the largest gains."""

    def wide(low: float, high: float) -> npt.NDArray[np.float64]:
        return np.asarray(np.exp(random.uniform(np.log(low), np.log(high), LANES)))

    columns: dict[str, npt.NDArray[np.float64]] = {}
    for name in CONTROLLER_COLUMNS[:8]:
        side = -1 if name in ("ne_c", "ze_a", "nce_c", "zce_a") else 1
        columns[name] = side * wide(164, 16384).round()
    columns["kp"] = wide(1, 64 * 65536).round() * (random.random(LANES) > 0.05)
    columns["kd"] = wide(1, 64 * 65536).round() * (random.random(LANES) > 0.05)
    columns["ki"] = wide(1, 1000 * 65536 / period_ms).round() * (random.random(LANES) > 0.1)
    columns["ku_mv"] = random.integers(0, 30001, LANES).astype(np.float64)
    columns["ce_ticks"] = random.integers(1, 21, LANES).astype(np.float64)
    return np.column_stack([columns[name] for name in CONTROLLER_COLUMNS]).astype(np.int32)


def random_angles(random: np.random.Generator) -> npt.NDArray[np.int32]:
    """Walks with small and large steps, and jumps from end to end."""
    walk = np.cumsum(random.normal(0, np.exp(random.uniform(0, 6, LANES)), (STEPS, LANES)), axis=0)
    jumps = np.where(random.random((STEPS, LANES)) < 0.01, random.integers(-32768, 32768, (STEPS, LANES)), 0)
    return np.clip(walk + jumps, -32768, 32767).astype(np.int32)


@pytest.mark.parametrize("instructions", _native.instruction_sets())
@pytest.mark.parametrize("period_ms", [1, 5])
def test_lanes_equal_the_firmware(instructions: str, period_ms: int) -> None:
    random = np.random.default_rng(period_ms)
    moved = 0
    for _ in range(12):
        controllers = random_controllers(random, period_ms)
        leader, follower = random_angles(random), random_angles(random)
        limit = random.choice(np.array([0, 100, 5000, 15000, 30000, 32767], dtype=np.uint16), STEPS)
        lanes: Any = _native.sixteen_laws(
            controllers=controllers,
            period_ms=period_ms,
            leader=leader,
            follower=follower,
            limit_mv=limit,
            instructions=instructions,
        )
        for lane in range(LANES):
            settings = _native.FuzzySettings()
            for column, name in enumerate(CONTROLLER_COLUMNS):
                setattr(settings, name, int(controllers[lane, column]))
            run: dict[str, Any] = _native.FuzzyController(settings, period_ms).run(
                leader[:, lane].astype(np.int16), follower[:, lane].astype(np.int16), limit
            )
            alone = np.asarray(run["volts_mv"])
            np.testing.assert_array_equal(lanes[:, lane], alone)
            moved += len(np.unique(alone))
    assert moved > 10_000
