"""The closed loop of four joints at a 1 ms tick: greywhale alone and in batches, beside MuJoCo and numba.

Each peer that is installed (`make oracles` does it) runs in the same process or right after; times are the best of
several repeats, for the machine may be busy. Figures are simulated seconds per second of one core unless they say
otherwise.
"""

from __future__ import annotations

import importlib
import importlib.util
import re
import subprocess
import tempfile
import time
from collections.abc import Callable
from pathlib import Path
from typing import Any

import numpy as np

from greywhale.arm.export import mjcf
from greywhale.arm.plants import columns
from greywhale.files.arm import default_arm
from greywhale.loop import Experiment, default_controller, human_reaches, plant_row
from tools import ROOT
from tools.benchmarks.figure import Figure, at_least

CANDIDATES = 512
SECONDS = 12.0
REPEATS = 7
PEERS = Path(__file__).parent / "peers"


def _best(work: Callable[[], object], clock: Callable[[], float], repeats: int = REPEATS) -> float:
    times = []
    for _ in range(repeats):
        start = clock()
        work()
        times.append(clock() - start)
    return min(times)


def run() -> list[Figure]:
    arm = default_arm()
    random = np.random.default_rng(1)
    plants = np.repeat(plant_row(arm)[None], CANDIDATES, axis=0)
    plants[:, columns("torque_per_volt")] *= np.exp(random.uniform(-0.3, 0.3, (CANDIDATES, 4)))
    controllers = np.repeat(default_controller()[None], CANDIDATES, axis=0)
    controllers[:, :, 8] = (controllers[:, :, 8] * random.uniform(0.7, 1.3, (CANDIDATES, 4))).astype(np.int32)
    experiment = Experiment(human_reaches(1, SECONDS), arm)
    simulated = experiment.ticks * 1e-3

    exact = simulated / _best(experiment.run_exact, time.process_time)
    quiet = Experiment(human_reaches(1, SECONDS), arm, noise=False)
    exact_quiet = simulated / _best(quiet.run_exact, time.process_time)
    figures = [
        at_least("closed loop, one candidate, no sensor noise", exact_quiet, "x real", 1000),
        Figure("closed loop, one candidate, sensor noise", exact, "x real"),
    ]
    batch = {}
    for steps in (1, 2, 4):

        def one_thread(steps: int = steps) -> object:
            return experiment.run(controllers, plants, steps_per_tick=steps, threads=1)

        batch[steps] = CANDIDATES * simulated / _best(one_thread, time.process_time)
        figures.append(Figure(f"closed loop, batch, {steps} steps a tick", batch[steps], "x real"))
    reach = max(batch.values())
    figures.append(at_least("closed loop, batch, fastest", reach, "x real", 40_000))
    return figures + _mujoco(reach) + _numba(reach, plants, experiment)


def _mujoco(ours: float) -> list[Figure]:
    found = importlib.util.find_spec("mujoco")
    if found is None or not found.submodule_search_locations:
        return []
    folder = Path(found.submodule_search_locations[0])
    library = next(folder.glob("libmujoco.so*"))
    law = ROOT / "firmware" / "lib" / "fuzzy_pdi" / "src"
    with tempfile.TemporaryDirectory() as name:
        program, model = Path(name) / "mujoco_loop", Path(name) / "arm.xml"
        sources = [str(PEERS / "mujoco_loop.cpp"), str(law / "fuzzy_pdi.cpp"), str(law / "compile.cpp")]
        headers = [f"-I{path}" for path in (folder / "include", law, ROOT / "firmware/lib/codes/src")]
        build = ["g++", "-std=c++17", "-O3", "-march=native", *headers, *sources, str(library)]
        subprocess.run([*build, f"-Wl,-rpath,{folder}", "-o", str(program)], check=True)
        model.write_text(mjcf(default_arm()), encoding="utf-8")
        without = Path(name) / "frictionless.xml"
        without.write_text(_without_friction(model.read_text(encoding="utf-8")), encoding="utf-8")

        def seconds_a_second(xml: Path) -> float:
            taken = []
            for _ in range(3):
                result = subprocess.run([str(program), str(xml), "10"], check=True, capture_output=True, text=True)
                taken.append(float(result.stdout))
            return 10.0 / min(taken)

        free, dry = seconds_a_second(without), seconds_a_second(model)
    best = max(free, dry)
    return [
        Figure("MuJoCo from C++, implicitfast, no dry friction", free, "x real"),
        Figure("MuJoCo from C++, implicitfast, dry friction", dry, "x real"),
        at_least("batch against MuJoCo without friction", ours / best, "x", 20),
    ]


def _without_friction(xml: str) -> str:
    return re.sub(r' frictionloss="[^"]*"', "", xml)


def _numba(ours: float, plants: np.ndarray, experiment: Experiment) -> list[Figure]:
    if importlib.util.find_spec("numba") is None:
        return []
    numba_loop: Any = importlib.import_module("tools.benchmarks.peers.numba_loop")

    gains = np.tile(np.array([2.0, 0.5, 4.0, 15.0]), (4, 1))
    some = np.ascontiguousarray(plants[:8])
    numba_loop.batch(some, gains, experiment.leader)
    taken = _best(lambda: numba_loop.batch(some, gains, experiment.leader), time.process_time)
    rate = len(some) * experiment.ticks * 1e-3 / taken
    return [
        Figure("numba, fastmath, no backlash, float controller", rate, "x real"),
        at_least("batch against numba", ours / rate, "x", 4),
    ]
