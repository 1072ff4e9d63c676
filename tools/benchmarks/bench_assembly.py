"""From a blank board to a commissioned arm: flash, calibrate, commission, against the same on the calibrated bench.

Each assembly has another zero, direction and track at all eight potentiometers, and one motor the wrong way round.
GREYWHALE_ASSEMBLIES names the seeds, GREYWHALE_KEEP a folder that gets all files of each run. A commissioning's result
differs from run to run, also on one bench: so the calibrated bench is commissioned several times, too.
"""

from __future__ import annotations

import contextlib
import os
import shutil
import subprocess
import sys
import tempfile
from pathlib import Path

import numpy as np

from greywhale.arm import ArmParameters
from greywhale.base.study import Task
from greywhale.cli.story import BenchProcess
from greywhale.files.arm import default_arm
from tools.benchmarks.bench_calibrate import LIKE, SECOND, error_of
from tools.benchmarks.figure import Figure
from tools.benchmarks.study import repeat
from tools.support.hands import Hands, mounted_anyhow, run_calibrate, save_arm

SEEDS = tuple(map(int, os.environ.get("GREYWHALE_ASSEMBLIES", " ".join(map(str, range(1, 21)))).split()))
USUAL_SEEDS = (1, 2, 3, 4)  # on the calibrated bench
KEEP = os.environ.get("GREYWHALE_KEEP")
NOMINAL = "white_box"  # what the person knows of the arm


def verb(bench: BenchProcess, folder: Path, *words: str) -> None:
    """Run `greywhale` on this bench as a script does; it must succeed."""
    command = [sys.executable, "-m", "greywhale", *words, "--port", bench.port]
    done = subprocess.run(command, cwd=folder, capture_output=True, text=True, check=False)
    if done.returncode:
        raise RuntimeError(f"greywhale {' '.join(words)}: {done.stderr}")


def commissioned(arm: ArmParameters, calibrate: bool, reversed_motor: int | None, seed: int) -> float:
    """The mean squared error (rad²) under a person's motion after all steps, from a blank board on."""
    with contextlib.ExitStack() as held:
        folder = Path(held.enter_context(tempfile.TemporaryDirectory()))
        bench = held.enter_context(BenchProcess("--speed", "max", "--blank", "--arm", save_arm(arm, folder)))
        if reversed_motor is not None:
            bench.command(f"motor {reversed_motor} reversed")
        verb(bench, folder, "flash")
        if calibrate:
            done = run_calibrate(Hands(bench), folder, *SECOND)
            if done.code:
                raise RuntimeError(done.said)
        verb(bench, folder, "arm", "match", NOMINAL, "--out", "matched.toml")
        verb(bench, folder, "commission", "--arm", "matched.toml", "--yes", "--seed", str(seed))
        error = error_of(bench, folder)
        if KEEP:
            which = "assembly" if calibrate else "calibrated"
            shutil.copytree(folder, Path(KEEP) / f"{which}-{seed}", dirs_exist_ok=True)
        return error


def on_the_calibrated_bench(seed: int) -> float:
    """The same for the default arm; its firmware's own parameters are its calibration."""
    return commissioned(default_arm(), calibrate=False, reversed_motor=None, seed=seed)


def assembled(seed: int) -> float:
    return commissioned(mounted_anyhow(seed), calibrate=True, reversed_motor=seed % 4, seed=seed)


def run() -> list[Figure]:
    tasks = [Task(f"calibrated bench {seed}", on_the_calibrated_bench, seed) for seed in USUAL_SEEDS]
    tasks += [Task(f"assembly {seed}", assembled, seed) for seed in SEEDS]
    errors = list(repeat("assembly", tasks).values())
    usual, assemblies = np.array(errors[: len(USUAL_SEEDS)]), np.array(errors[len(USUAL_SEEDS) :])
    middle = float(np.median(usual))
    ratios = assemblies / middle
    worse, typical = float(ratios.max()), float(np.median(ratios))
    return [
        Figure("calibrated bench, commissioned from a blank board: MSE, median", 1e6 * middle, "mrad²"),
        *(
            Figure(f"calibrated bench, seed {seed}: MSE / median", error / middle, "x")
            for seed, error in zip(USUAL_SEEDS, usual, strict=True)
        ),
        *(
            Figure(f"assembly {seed}: MSE / median of the calibrated bench", ratio, "x")
            for seed, ratio in zip(SEEDS, ratios, strict=True)
        ),
        Figure("assemblies: median / calibrated bench", typical, "x", f"<= {1 + LIKE}", typical <= 1 + LIKE),
        Figure("assemblies: worst / calibrated bench", worse, "x", f"<= {1 + LIKE}", worse <= 1 + LIKE),
    ]
