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
from tools.bench.bench_calibrate import LIKE, SECOND, error_of
from tools.bench.figure import Figure
from tools.bench.hands import Hands, bench_of, mounted_anyhow, run_calibrate

SEEDS = tuple(map(int, os.environ.get("GREYWHALE_ASSEMBLIES", " ".join(map(str, range(1, 21)))).split()))
NOMINAL = "white_box"  # what the person knows of the arm


def verb(bench: BenchProcess, folder: Path, *words: str) -> None:
    """Run `greywhale` on this bench as a script does; it must succeed."""
    command = [sys.executable, "-m", "greywhale", *words, "--port", bench.port]
    done = subprocess.run(command, cwd=folder, capture_output=True, text=True, check=False)
    if done.returncode:
        raise RuntimeError(f"greywhale {' '.join(words)}: {done.stderr}")


def commissioned(arm: ArmParameters, folder: Path, calibrate: bool, reversed_motor: int | None) -> float:
    """The mean squared error (rad²) under a person's motion after all steps, from a blank board on."""
    with bench_of(arm, folder, "--blank") as bench:
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


def run() -> list[Figure]:
    with tempfile.TemporaryDirectory() as name:
        usual = commissioned(default_arm(), Path(name), calibrate=False, reversed_motor=None)
    ratios = []
    for seed in SEEDS:
        with tempfile.TemporaryDirectory() as name:
            error = commissioned(mounted_anyhow(seed), Path(name), calibrate=True, reversed_motor=seed % 4)
        ratios.append(error / usual)
    worse = float(np.max(ratios))
    return [
        Figure("calibrated bench, commissioned from a blank board: MSE", 1e6 * usual, "mrad²"),
        *(
            Figure(f"assembly {seed}: MSE / calibrated bench", ratio, "x")
            for seed, ratio in zip(SEEDS, ratios, strict=True)
        ),
        Figure("assemblies: worst / calibrated bench", worse, "x", f"<= {1 + LIKE}", worse <= 1 + LIKE),
    ]
