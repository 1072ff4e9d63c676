"""A person at the bench who does what `greywhale calibrate` asks, line by line; and arms mounted anyhow."""

from __future__ import annotations

import contextlib
import os
import re
import subprocess
import sys
import threading
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

import numpy as np
import numpy.typing as npt

from greywhale.arm import ArmParameters
from greywhale.demo import BenchProcess
from greywhale.files.arm import default_arm
from greywhale.files.model import arm_toml
from greywhale.firmware import JOINTS

Floats = npt.NDArray[np.float64]

SWEEP_S = 0.5  # a way; a person is slower
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


def bench_of(arm: ArmParameters, folder: Path, *options: str) -> BenchProcess:
    """A running bench with this arm."""
    path = folder / "arm.toml"
    path.write_text(arm_toml(arm, "Mounted anyhow."), encoding="utf-8")
    return BenchProcess("--speed", "max", "--arm", str(path), *options)


@dataclass
class Hands:
    """Turns joints, holds poses; `second` is what it holds where the second pose is asked for, in degrees."""

    bench: BenchProcess
    second: Floats = field(default_factory=SECOND_DEG.copy)
    apart: float = 0.0  # degrees by which the follower's joint 1 is held elsewhere in the third pose
    poses: int = 0

    def follow(self, asked: str) -> None:
        """Do what a line of `greywhale calibrate` asks."""
        if sweep := re.match(r"Sweep .*: (leader|follower) joint (\d)", asked):
            self.do(f"turn {sweep[1]} {sweep[2]} {SWEEP_S}")
        elif asked.startswith("Each motor"):
            self.do("hang")
        elif " pose" in asked:
            self.poses += 1
            pose = {2: self.second, 4: THIRD_DEG}.get(self.poses, np.zeros(JOINTS))
            self.bring("both", pose)
            if self.poses == 4 and self.apart:
                self.bring("follower", pose + self.apart * np.eye(JOINTS)[1])

    def bring(self, side: str, degrees: Floats, seconds: float = 1.0) -> None:
        """Bring one arm or both there, and wait until they are."""
        angles = " ".join(f"{angle:.6f}" for angle in np.radians(degrees))
        self.do(f"hand {side} {angles} {seconds}")

    def do(self, command: str) -> None:
        """Give the hands a command, and wait until they are where it sends them."""
        arrives = self.bench.command(command)["arrives_s"]
        while self.bench.command("status")["time_s"] < arrives:
            pass


@dataclass(frozen=True)
class Calibrated:
    """How a run of the verb ended, what it printed, and what it said on its way."""

    code: int
    printed: str
    said: str


def run_calibrate(hands: Hands, folder: Path, *more: str) -> Calibrated:
    """`greywhale calibrate` in a process of its own, in that folder."""
    command = [sys.executable, "-m", "greywhale", "calibrate", "--port", hands.bench.port, "--yes", "--json", *more]
    with subprocess.Popen(
        command, cwd=folder, text=True, stdin=subprocess.PIPE, stdout=subprocess.PIPE, stderr=subprocess.PIPE
    ) as process:
        assert process.stdin is not None
        assert process.stdout is not None
        assert process.stderr is not None
        out, said, printed = process.stdout, [], [""]

        def read() -> None:
            printed[0] = out.read()

        reader = threading.Thread(target=read)
        reader.start()
        for line in process.stderr:
            said.append(line)
            if line.rstrip().endswith("[Enter]"):
                hands.follow(line)
                with contextlib.suppress(BrokenPipeError):  # it has ended, and says why
                    os.write(process.stdin.fileno(), b"\n")
        reader.join()
    return Calibrated(process.returncode, printed[0], "".join(said))
