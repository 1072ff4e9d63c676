"""Mistakes between the potentiometers and the converter: swapped wires, slipping shafts, loose contacts, noise."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np

from greywhale.base.types import Floats

SLICE_S = 250e-6
SLIPS = 0.3  # of every way up is lost, so that the same angle reads lower each time
LOOSE_EVERY, LOOSE_FOR = 920, 8  # slices: a wire with a pull-down is off for 2 ms in 230 ms
SUPPLY_MV, NOISE_MV = 5000.0, 30.0
NOISY_MV = 100.0  # rms, of a wiper's wire along a motor's
HUM_MV, HUM_HZ = 25.0, 50.0
TRACK_SHARE = 300.0 / 360.0  # of a turn; the rest is the dead zone
PULL_DOWN = 10.0  # how many times its resistance is the track's

PotFault = Callable[[float, int], float]  # the true voltage and the slice's number -> what is shown


class PotFaults:
    """Changes the eight voltages (mV) of a slice; `any` tells whether there is anything to change."""

    def __init__(self) -> None:
        self.order = list(range(8))  # which potentiometer is on each input
        self._faults: dict[int, PotFault] = {}
        self._touching: tuple[int, int] | None = None
        self._slice = 0
        self.any = False

    def inject(self, pot: int, kind: str | None) -> None:
        """Let potentiometer 0..7 (leader, follower) lie in this way from now on; None: it tells the truth again."""
        self._faults.pop(pot, None)
        if kind is not None:
            self._faults[pot] = KINDS[kind]()
        self._look()

    def swap(self, one: int, other: int) -> None:
        """Exchange the wires of two inputs."""
        self.order[one], self.order[other] = self.order[other], self.order[one]
        self._look()

    def touch(self, one: int, other: int) -> None:
        """Let the wipers' wires of two potentiometers touch."""
        self._touching = (one, other)
        self._look()

    def apply(self, millivolts: Floats) -> None:
        """Change the voltages in place, once a slice."""
        self._slice += 1
        for pot, fault in self._faults.items():
            millivolts[pot] = min(max(fault(float(millivolts[pot]), self._slice), 0.0), SUPPLY_MV)
        if self._touching is not None:  # of one make: each pulls as hard
            millivolts[list(self._touching)] = millivolts[list(self._touching)].mean()
        millivolts[:] = millivolts[self.order]

    def _look(self) -> None:
        self.any = bool(self._faults) or self._touching is not None or self.order != list(range(8))


class _Frozen:
    def __init__(self) -> None:
        self._shown: float | None = None

    def __call__(self, true: float, number: int) -> float:
        self._shown = true if self._shown is None else self._shown
        return self._shown


class _Slipping:
    def __init__(self) -> None:
        self._had = self._shown = -1.0

    def __call__(self, true: float, number: int) -> float:
        if self._had < 0.0:
            self._had = self._shown = true
        way = true - self._had
        if abs(way) < NOISE_MV:  # does not move the shaft
            return min(max(self._shown + way, 0.0), SUPPLY_MV)
        self._had = true
        self._shown = min(max(self._shown + (way * (1.0 - SLIPS) if way > 0.0 else way), 0.0), SUPPLY_MV)
        return self._shown


class _Noisy:
    def __init__(self) -> None:
        self._random = np.random.default_rng(1)

    def __call__(self, true: float, number: int) -> float:
        return true + NOISY_MV * float(self._random.standard_normal())


def _loose(true: float, number: int) -> float:
    return 0.0 if number % LOOSE_EVERY < LOOSE_FOR else true


def _humming(true: float, number: int) -> float:
    return true + HUM_MV * float(np.sin(2.0 * np.pi * HUM_HZ * SLICE_S * number))


def _reversed(true: float, number: int) -> float:
    return SUPPLY_MV - true


def _turned(true: float, number: int) -> float:
    """Its shaft is half a turn farther in its coupling: the dead zone, where the wiper touches nothing, comes first."""
    turn = (TRACK_SHARE * true / SUPPLY_MV + 0.5) % 1.0
    return SUPPLY_MV * turn / TRACK_SHARE if turn <= TRACK_SHARE else 0.0


def _crossed(true: float, number: int) -> float:
    """The wiper is on 5 V and an end of the track on the input: only the pull-down's current makes a difference."""
    return SUPPLY_MV * PULL_DOWN / (PULL_DOWN + 1.0 - true / SUPPLY_MV)


KINDS: dict[str, Callable[[], PotFault]] = {
    "frozen": _Frozen,
    "slipping": _Slipping,
    "loose": lambda: _loose,
    "noisy": _Noisy,
    "humming": lambda: _humming,
    "reversed": lambda: _reversed,
    "turned": lambda: _turned,
    "crossed": lambda: _crossed,
}
