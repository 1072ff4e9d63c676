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
JOINTS = 4


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
        pack = getattr(self, f"_{name}")

        def call(**arguments: Any) -> Any:
            result = real(**arguments)
            values = result if isinstance(result, tuple) else (result,)
            self.keep(name, pack(**arguments), dict(zip(parts, map(np.asarray, values), strict=True)))
            return result

        return call

    def _closed_loop(self, real: Any) -> Any:
        calls = self

        class ClosedLoop:
            def __init__(self, **arguments: Any) -> None:
                self._real = real(**arguments)
                self._packed = calls.pack_experiment(**arguments)

            def run(self, **arguments: Any) -> Any:
                result = self._real.run(**arguments)
                names = ("mse", "itae", "itau", "diverged", "angles", "duties")
                calls.keep("run", self._packed + calls.pack_run(**arguments), dict(zip(names, result, strict=True)))
                return result

        return ClosedLoop

    def _settings(self, settings: object) -> bytes:
        given = self._made[id(settings)][1]
        names = ("period_ms", "supply_mv", "soft_start_ms", "filter_shift", "limit_min", "limit_max", "motor_sign")
        calibration = ("leader_zero", "leader_scale", "follower_zero", "follower_scale")
        return b"".join(wholes(given[name]) for name in (*names, "pwm_top", *calibration))

    def _timing(self, timing: object) -> bytes:
        given = self._made[id(timing)][1]
        return b"".join(wholes(given[name]) for name in ("start", "acts", "on", "late"))

    def _pots(self, pots: list[object]) -> bytes:
        names = ("track", "centre", "direction", "noise", "linearity", "play", "lag")
        return b"".join(reals(self._made[id(pot)][1][name]) for pot in pots for name in names)

    def _board(self, settings: object, timing: object, pots: list[object], pot_supply: float, seed: int) -> bytes:
        return self._settings(settings) + self._timing(timing) + self._pots(pots) + reals(pot_supply) + wholes(seed)

    def _leader_readings(self, *, angles: Array, **board: Any) -> bytes:
        return self._board(**board) + array(angles, np.float64)

    def pack_experiment(
        self, *, home: Any, gap: Any, reference: Array, leader: Array, weight: Array, **board: Any
    ) -> bytes:
        arrays = array(reference, np.int16) + array(leader, np.float64) + array(weight, np.float64)
        return self._board(**board) + reals(home) + reals(gap) + arrays

    @staticmethod
    def pack_run(*, controllers: Array, plants: Array, substeps: int, every: int, exact: bool, **_: Any) -> bytes:
        return array(controllers, np.int32) + array(plants, np.float64) + wholes([substeps, every, exact])

    @staticmethod
    def _sixteen_laws(
        *, controllers: Array, period_ms: int, leader: Array, follower: Array, limit_mv: Array, **_: Any
    ) -> bytes:
        angles = array(leader, np.int32) + array(follower, np.int32)
        return array(controllers, np.int32) + wholes(period_ms) + angles + array(limit_mv, np.uint16)

    @staticmethod
    def _simulate_windows(**given: Any) -> bytes:
        names = ("angles", "velocities", "sides", "places")
        return b"".join(
            (
                *(array(given[name], np.float64) for name in ("plants", "offsets", "kicks")),
                array(given["first"], np.int64),
                *(array(given[name], np.float64) for name in names),
                wholes(given["rows"]),
                array(given["volts"], np.float64),
                array(given["spacing"], np.float64),
                wholes([given["substeps"], given["every"]]),
            )
        )

    @staticmethod
    def _simulate_ideal(**given: Any) -> bytes:
        assert given["keep"], "the driver always gives the angles"
        return b"".join(
            (
                array(given["leader"], np.float64),
                wholes(given["late"]),
                array(given["plant"], np.float64),
                reals(given["supply"]),
                array(given["tunings"], np.float64),
                wholes(given["chased"]),
                array(given["direction"], np.int8),
                array(given["until"], np.float64),
            )
        )


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
    """What the driver wrote, call by call, in the shapes and types of the results here."""
    found, offset = [], 0
    for call in calls:
        results = {}
        for name, here in call.results.items():
            results[name] = np.frombuffer(data, here.dtype, here.size, offset).reshape(here.shape)
            offset += here.nbytes
        found.append(results)
    assert offset == len(data)
    return found
