"""Calls of greywhale._native, kept with their results and written down, so that another target can repeat them."""

from __future__ import annotations

import struct
from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any

import numpy as np
import numpy.typing as npt
import pytest

from greywhale import _native

Array = npt.NDArray[Any]
# The arguments of a function in the order of driver.cpp: arrays with their type, reals with "real", else whole numbers.
BOARD = "settings timing pots pot_supply:real seed"
ARGUMENTS = {
    "leader_readings": f"{BOARD} angles:float64",
    "sixteen_laws": "controllers:int32 period_ms leader:int32 follower:int32 limit_mv:uint16",
    "simulate_windows": "plants:float64 offsets:float64 first:int64 angles:float64 velocities:float64 "
    "sides:float64 places:float64 rows volts:float64 spacing:float64 substeps every",
    "simulate_ideal": "leader:float64 late plant:float64 supply:real tunings:float64 chased direction:int8 "
    "until:float64",
}
EXPERIMENT = f"{BOARD} home:real gap:real reference:int16 leader:float64 weight:float64"
RUN = "controllers:int32 plants:float64 substeps every exact"
SETTINGS = (
    "period_ms supply_mv soft_start_ms filter_shift limit_min limit_max motor_sign pwm_top "
    "leader_zero leader_scale follower_zero follower_scale"
)
TIMING = "start acts on late"
POT = "track:real centre:real direction:real noise:real linearity:real play:real lag:real"


@dataclass(frozen=True)
class Call:
    """A function's name, its arguments as bytes in the order of driver.cpp, and what it gave here by name."""

    name: str
    arguments: bytes
    results: Mapping[str, Array]


class Calls:
    """Stands before greywhale._native: passes calls on, and keeps those that matter."""

    def __init__(self, monkeypatch: pytest.MonkeyPatch) -> None:
        self.kept: list[Call] = []
        self._made: dict[int, tuple[object, dict[str, Any]]] = {}
        for name in ("LoopSettings", "LoopTiming", "Potentiometer"):
            monkeypatch.setattr(_native, name, self._remembered(getattr(_native, name)))
        monkeypatch.setattr(_native, "ClosedLoop", self._closed_loop(_native.ClosedLoop))
        for name, parts in (
            ("leader_readings", ("reference", "leader")),
            ("sixteen_laws", ("millivolts",)),
            ("simulate_windows", ("angles",)),
            ("simulate_ideal", ("mse", "angles")),
        ):
            monkeypatch.setattr(_native, name, self._kept(name, getattr(_native, name), parts))

    def keep(self, name: str, arguments: bytes, results: Mapping[str, Array]) -> None:
        self.kept.append(Call(name, arguments, results))

    def _remembered(self, real: Any) -> Any:
        def make(**arguments: Any) -> Any:
            made = real(**arguments)
            self._made[id(made)] = (made, arguments)
            return made

        return make

    def _kept(self, name: str, real: Any, parts: tuple[str, ...]) -> Any:
        def call(**arguments: Any) -> Any:
            assert arguments.get("keep", True), "the driver always gives the angles"
            result = real(**arguments)
            values = result if isinstance(result, tuple) else (result,)
            packed = self.packed(ARGUMENTS[name], arguments)
            self.keep(name, packed, dict(zip(parts, map(np.asarray, values), strict=True)))
            return result

        return call

    def _closed_loop(self, real: Any) -> Any:
        calls = self

        class ClosedLoop:
            def __init__(self, **arguments: Any) -> None:
                self._real = real(**arguments)
                self._packed = calls.packed(EXPERIMENT, arguments)

            def run(self, **arguments: Any) -> Any:
                result = self._real.run(**arguments)
                names = ("mse", "itae", "itau", "diverged", "angles", "duties")
                calls.keep("run", self._packed + calls.packed(RUN, arguments), dict(zip(names, result, strict=True)))
                return result

        return ClosedLoop

    def packed(self, names: str, given: Mapping[str, Any]) -> bytes:
        """Arguments as the driver reads them; those that were made before are packed by what they were made of."""
        return b"".join(
            self._one(given[name], kind, name) for name, _, kind in (one.partition(":") for one in names.split())
        )

    def _one(self, value: Any, kind: str, name: str) -> bytes:
        made = {"settings": SETTINGS, "timing": TIMING, "pots": POT}.get(name)
        if made is not None:
            parts = value if isinstance(value, list) else [value]
            return b"".join(self.packed(made, self._made[id(part)][1]) for part in parts)
        if not kind:
            return wholes(value)
        return reals(value) if kind == "real" else array(value, kind)


def wholes(values: Any) -> bytes:
    return np.asarray(values).astype(np.int64).tobytes()


def reals(values: Any) -> bytes:
    return np.asarray(values, dtype=np.float64).tobytes()


def array(values: Array, kind: Any) -> bytes:
    assert values.dtype == kind
    return struct.pack("<q", values.size) + np.ascontiguousarray(values).tobytes()


def written(calls: list[Call]) -> bytes:
    """All of them, as the driver reads them."""
    return b"".join(array(np.frombuffer(call.name.encode(), np.int8), np.int8) + call.arguments for call in calls)


def read(calls: list[Call], data: bytes) -> list[dict[str, Array]]:
    """The driver's output, call by call, in the shapes and types of the results here."""
    found, offset = [], 0
    for call in calls:
        results = {}
        for name, here in call.results.items():
            results[name] = np.frombuffer(data, here.dtype, here.size, offset).reshape(here.shape)
            offset += here.nbytes
        found.append(results)
    assert offset == len(data)
    return found
