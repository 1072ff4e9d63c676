"""Sweeps, poses and pulses of a calibration, and what the host makes of them."""

from __future__ import annotations

from dataclasses import asdict, dataclass, field
from typing import Any
from unittest.mock import Mock

import numpy as np
import pytest

from greywhale.base.errors import UserError
from greywhale.base.types import Floats
from greywhale.board.calibrate.motors import Motor, examine_motor, pulse_table, remarks
from greywhale.board.calibrate.solve import Pose, solve
from greywhale.board.calibrate.sweep import Sweep, judge_sweep
from greywhale.protocol.table import ParameterTable
from tests.board.calibrate.test_sweep import MISTAKES, swept

TABLE = ParameterTable.defaults()


def calibrations(patch: pytest.MonkeyPatch) -> dict[str, Any]:
    """All of it."""
    pulses = {"pulse_set": pulse_table(TABLE, 2, 2.5).raw}
    return {"solved": solved_poses(), "swept": swept_joints(), **pulses, **tried_motors(patch)}


def swept_joints() -> list[dict[str, Any]]:
    """Recordings of sweeps, right and with each mistake, and what the host says of them."""
    cases = []
    for pot, counts, _ in [(1, swept(1), ""), (6, swept(6, -250.0), ""), *MISTAKES]:
        sweep = asdict(judge_sweep(counts, pot))
        told = {name: sweep[name] for name in ("direction", "low", "high")} | {"mistake": " ".join(sweep["mistakes"])}
        cases.append({"counts": counts.T.tolist(), "pot": pot, "sweep": told})
    return cases


def solved_poses() -> list[dict[str, Any]]:
    """Sweeps and poses of arms whose potentiometers are mounted anyhow, and some that contradict each other."""
    chance = np.random.default_rng(1)
    cases: list[dict[str, Any]] = []
    for slip in ["", "", "", "poses too near", "shaft slips", "other way", "other ends"]:
        scale = np.radians(chance.uniform(260, 340, 8)) / 1023 * chance.choice([-1, 1], 8)
        zero = chance.uniform(400, 600, 8)
        ends = chance.uniform(1.0, 1.4, (8, 2)) * [-1, 1]
        poses = [np.zeros(4), chance.choice([-1, 1], 4) * (0.2 if slip == "poses too near" else 0.8)]
        counts = [zero + np.tile(pose, 2) / scale for pose in poses]
        if slip == "shaft slips":
            counts[1][6] = counts[0][6] + 20
        if slip == "other ends":
            ends[4] = [1.1, 1.4]
            ends[0] = [-1.4, 1.0]
        turned = np.sort(zero[:, None] + ends / scale[:, None], axis=1)
        ways = np.sign(scale) * np.where(np.arange(8) == 3, -1 if slip == "other way" else 1, 1)
        sweeps = [Sweep(pot, int(ways[pot]), low, high, ()) for pot, (low, high) in enumerate(turned.tolist())]
        first, second = (Pose(angles, read) for angles, read in zip(poses, counts, strict=True))
        told: dict[str, Any] = {"sweeps": [asdict(sweep) for sweep in sweeps]}
        told |= {
            name: {"angles": one.angles.tolist(), "counts": one.counts.tolist()}
            for name, one in (("first", first), ("second", second))
        }
        try:
            cases.append({**told, "raw": solve(sweeps, first, second, None).changes(), "error": ""})
        except UserError as error:
            cases.append({**told, "raw": None, "error": error.message})
    assert [one["raw"] is None for one in cases] == 3 * [False] + 4 * [True]
    return cases


@dataclass
class Wired:
    """A motor that moves a joint by so much a volt, from so many volts on, of an arm that falls in some pulses."""

    joint: int
    moves: int
    gain: float
    least_v: float = 0.0
    falls: tuple[int, ...] = ()
    pulses: list[dict[str, Any]] = field(default_factory=list)

    def pulse(self, device: object, weak: ParameterTable, joint: int, way: int) -> Floats:
        volts = weak[f"joint{joint}.ku_mv"] / 1000.0
        moved = np.zeros(4)
        moved[self.moves] = self.gain * way * volts * (volts > self.least_v)
        moved[1] -= 0.1 * (len(self.pulses) in self.falls)
        self.pulses.append({"way": way, "moved": moved.tolist()})
        return moved


def tried_motors(patch: pytest.MonkeyPatch) -> dict[str, Any]:
    """Each pulse's way and where it moved the joints, what the host finds of the motor, and its remarks."""
    cases: list[dict[str, Any]] = []
    found: list[Motor] = []
    for wired in (
        Wired(0, 0, 0.03),
        Wired(1, 1, -0.03, 2.0),
        Wired(2, 2, 0.006, 3.0),
        Wired(3, 3, 0.02, 5.0, (0,)),
        Wired(0, 0, 0.03, 99.0, (1,)),
        Wired(1, 2, 0.04),
        Wired(2, 2, 0.03, 0.0, (2,)),
    ):
        patch.setattr("greywhale.board.calibrate.motors.pulse", wired.pulse)
        told: dict[str, Any] = {"joint": wired.joint, "pulses": wired.pulses, "motor": None, "error": ""}
        try:
            found.append(examine_motor(Mock(port="port"), TABLE, wired.joint))
            told["motor"] = asdict(found[-1])
        except UserError as error:
            told["error"] = error.message.removeprefix("port: ")
        cases.append(told)
    groups: list[list[Motor]] = [found[:3], found[1:4], found[3:4], []]
    said = [{"motors": [asdict(one) for one in group], "remarks": remarks(group, TABLE.supply_v)} for group in groups]
    assert [len(one["remarks"]) for one in said] == [1, 1, 1, 0]
    return {"tried": cases, "remarks": said}
