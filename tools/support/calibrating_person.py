"""A person at the bench who does what `greywhale calibrate` asks, line by line; and arms mounted anyhow."""

from __future__ import annotations

import contextlib
import io
import re
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any
from unittest import mock

import numpy as np

from greywhale.arm import ArmParameters
from greywhale.base.types import Floats
from greywhale.board.calibrate import PersonAnswer
from greywhale.cli import calibrate as verb
from greywhale.cli.entry import run
from greywhale.cli.story import RunningBench
from greywhale.files.arm import default_arm
from greywhale.files.model import arm_toml
from greywhale.protocol.firmware import JOINTS
from greywhale_sim.lockstep import LockStepBench
from greywhale_sim.words import lock_step

BACKUP = "before-calibration.toml"
SWEEP_S, POSE_S = 0.5, 1.0  # a way, and to a pose; a person is slower
SECOND_DEG = np.array([60.0, 50.0, -45.0, 40.0])
THIRD_DEG = np.array([-35.0, -20.0, 30.0, -40.0])
TRACK_RAD, CENTRE_RAD = (4.7, 5.8), (-0.6, 0.6)


def mounted_anyhow(seed: int) -> ArmParameters:
    """The default arm with another zero, direction and track at each of the eight potentiometers."""
    random = np.random.default_rng(seed)
    arm = default_arm()

    def bank() -> Any:
        made = [
            pot.model_copy(
                update={
                    "track": float(random.uniform(*TRACK_RAD)),
                    "centre": float(random.uniform(*CENTRE_RAD)),
                    "direction": int(random.choice((-1, 1))),
                }
            )
            for pot in arm.leader_pots.joint
        ]
        return arm.leader_pots.model_copy(update={"joint": tuple(made)})

    return arm.model_copy(update={"leader_pots": bank(), "follower_pots": bank()})


def bench_of(arm: ArmParameters, folder: Path, *options: str) -> LockStepBench:
    """A running bench with this arm."""
    return lock_step("--arm", save_arm(arm, folder), *options)


def save_arm(arm: ArmParameters, folder: Path) -> str:
    """The arm's file in that folder."""
    path = folder / "arm.toml"
    path.write_text(arm_toml(arm, "Mounted anyhow."), encoding="utf-8")
    return str(path)


@dataclass
class CalibratingPerson:
    """Turns joints, holds poses; `second` is what it holds where the second pose is asked for, in degrees.

    It stands for the person at the terminal, as `greywhale.cli.person` does for a real one.
    """

    bench: RunningBench
    second: Floats = field(default_factory=SECOND_DEG.copy)
    sweep_s: float = SWEEP_S
    pose_s: float = POSE_S
    apart: float = 0.0  # degrees by which the follower's joint 1 is held elsewhere in the third pose
    poses: int = 0
    patient: bool = False
    said: list[str] = field(default_factory=list)  # all that it was asked and told
    _arrives_s: float = 0.0

    def ask(self, what: str) -> None:
        self.said.append(what)
        self.follow(what)

    def show(self, live: str) -> None:
        """It feels what it does."""

    def answer(self) -> PersonAnswer | None:
        return PersonAnswer.DONE if self._time_s() >= self._arrives_s else None

    def tell(self, what: str) -> None:
        self.said.append(what)

    def close(self) -> None:
        """It stays."""

    def follow(self, asked: str) -> None:
        """Do what a line of `greywhale calibrate` asks."""
        if sweep := re.match(r"Sweep .*: (leader|follower) joint (\d)", asked):
            self.begin(f"turn {sweep[1]} {sweep[2]} {self.sweep_s}")
        elif asked.startswith("Each motor"):
            self.begin("hang")
        elif " pose" in asked:
            self.poses += 1
            pose = {2: self.second, 4: THIRD_DEG}.get(self.poses, np.zeros(JOINTS))
            self.begin(_hand("both", pose, self.pose_s))
            if self.poses == 4 and self.apart:
                self.begin(_hand("follower", pose + self.apart * np.eye(JOINTS)[1], self.pose_s))

    def bring(self, side: str, degrees: Floats, seconds: float = POSE_S) -> None:
        """Bring one arm or both there, and wait until they are."""
        self.do(_hand(side, degrees, seconds))

    def do(self, command: str) -> None:
        """Give the bench a command to the person, and wait until it is carried out."""
        self.begin(command)
        while self.answer() is None:
            pass

    def begin(self, command: str) -> None:
        self._arrives_s = self.bench.command(command)["arrives_s"]

    def _time_s(self) -> float:
        return float(self.bench.command("status")["time_s"])


def _hand(side: str, degrees: Floats, seconds: float) -> str:
    return f"hand {side} {' '.join(f'{angle:.6f}' for angle in np.radians(degrees))} {seconds}"


def quick_person(bench: RunningBench) -> CalibratingPerson:
    """For tests of what does not depend on the pace."""
    return CalibratingPerson(bench, sweep_s=0.3, pose_s=0.3)


@dataclass(frozen=True)
class Calibrated:
    """A run of the verb: its exit code, what it printed, and what it said on its way."""

    code: int
    printed: str
    said: str


def run_calibrate(person: CalibratingPerson, folder: Path, *more: str) -> Calibrated:
    """`greywhale calibrate` in that folder, with this person at the terminal."""
    out, said = io.StringIO(), io.StringIO()
    words = ["calibrate", "--port", person.bench.port, "--yes", "--json", "--backup", f"{folder}/{BACKUP}", *more]
    with mock.patch.object(verb, "Terminal", return_value=person):
        with contextlib.redirect_stdout(out), contextlib.redirect_stderr(said):
            code = run(words)
    return Calibrated(code, out.getvalue(), "\n".join([*person.said, said.getvalue()]))
