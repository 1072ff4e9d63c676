"""From a blank board to a commissioned arm: flash, calibrate, commission, against the same on the calibrated bench.

Each assembly has another zero, direction and track at all eight potentiometers, and one motor the wrong way round.
GREYWHALE_ASSEMBLIES names the seeds.
"""

from __future__ import annotations

import os
import subprocess
import sys
import tempfile
from pathlib import Path

import numpy as np

from greywhale.arm import ArmParameters
from greywhale.demo import BenchProcess
from greywhale.files.arm import default_arm
from greywhale.study import Task
from tools.bench.bench_calibrate import LIKE, SECOND, error_of
from tools.bench.figure import Figure
from tools.bench.hands import Hands, bench_of, mounted_anyhow, run_calibrate
from tools.bench.study import repeat

SEEDS = tuple(map(int, os.environ.get("GREYWHALE_ASSEMBLIES", " ".join(map(str, range(1, 21)))).split()))
NOMINAL = "white_box"  # what the person knows of the arm


def verb(bench: BenchProcess, folder: Path, *words: str) -> None:
    """Run `greywhale` on this bench as a script does; it must succeed."""
    command = [sys.executable, "-m", "greywhale", *words, "--port", bench.port]
    done = subprocess.run(command, cwd=folder, capture_output=True, text=True, check=False)
    if done.returncode:
        raise RuntimeError(f"greywhale {' '.join(words)}: {done.stderr}")


def commissioned(arm: ArmParameters, calibrate: bool, reversed_motor: int | None) -> float:
    """The mean squared error (rad²) under a person's motion after all steps, from a blank board on."""
    with tempfile.TemporaryDirectory() as name, bench_of(arm, Path(name), "--blank") as bench:
        folder = Path(name)
        if reversed_motor is not None:
            bench.command(f"motor {reversed_motor} reversed")
        verb(bench, folder, "flash")
        if calibrate:
            done = run_calibrate(Hands(bench), folder, *SECOND)
            if done.code:
                raise RuntimeError(done.said)
        verb(bench, folder, "arm", "match", NOMINAL, "--out", "matched.toml")
        verb(bench, folder, "commission", "--arm", "matched.toml", "--yes")
        return error_of(bench, folder)


def on_the_calibrated_bench(seed: int) -> float:
    """The same for the default arm; its firmware's own parameters are its calibration."""
    return commissioned(default_arm(), calibrate=False, reversed_motor=None)


def assembled(seed: int) -> float:
    return commissioned(mounted_anyhow(seed), calibrate=True, reversed_motor=seed % 4)


def run() -> list[Figure]:
    tasks = [Task("calibrated bench", on_the_calibrated_bench, 0)]
    tasks += [Task(f"assembly {seed}", assembled, seed) for seed in SEEDS]
    usual, *errors = repeat("assembly", tasks).values()
    ratios = [error / usual for error in errors]
    worse = float(np.max(ratios))
    return [
        Figure("calibrated bench, commissioned from a blank board: MSE", 1e6 * usual, "mrad²"),
        *(
            Figure(f"assembly {seed}: MSE / calibrated bench", ratio, "x")
            for seed, ratio in zip(SEEDS, ratios, strict=True)
        ),
        Figure("assemblies: worst / calibrated bench", worse, "x", f"<= {1 + LIKE}", worse <= 1 + LIKE),
    ]
