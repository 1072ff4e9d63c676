"""The native code compiled for 64-bit ARM (under qemu) and for wasm (in Node.js) gives the same bits as here.

The library greywhale_core is compiled, by the package's own CMake file; tests/oracles/other_targets/driver.cpp repeats
the calls that the package makes of its native module.
"""

from __future__ import annotations

import subprocess
import sys
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from greywhale import _native
from greywhale.arm import ArmParameters
from greywhale.arm.plants import column, columns
from greywhale.files.arm import default_arm, load_arm
from greywhale.files.trajectory import Trajectory
from greywhale.loop import CONTROLLER_COLUMNS, PLANT_COLUMNS, Experiment, Timing, human_reaches, plant_row
from greywhale.loop.leader import leader_slices
from greywhale.protocol.schema import Board
from greywhale.protocol.table import ParameterTable
from tests.identify.test_windows import arguments as windows_of_test
from tests.loop.test_batch import search_box
from tests.loop.test_law_in_lanes import random_angles, random_controllers
from tests.oracles.native_calls import Calls, read, written
from tools.setup import page

HERE = Path(__file__).parent
BUILD = HERE.parents[1] / "build" / "oracles"
CMAKE = {
    "aarch64": {
        "SYSTEM_NAME": "Linux",
        "SYSTEM_PROCESSOR": "aarch64",
        "CXX_COMPILER": "aarch64-linux-gnu-g++",
    },
    "wasm": {
        "SYSTEM_NAME": "Generic",
        "SYSTEM_PROCESSOR": "wasm32",
        "CXX_COMPILER": "clang++",
        "CXX_COMPILER_TARGET": "wasm32-wasi",
        "CXX_FLAGS": "-fexceptions -msimd128",
        "TRY_COMPILE_TARGET_TYPE": "STATIC_LIBRARY",
    },
}


MOVES_S = 1.6  # a product that is rounded otherwise shows within a tick


@dataclass(frozen=True)
class Driver:
    """The program for a target, and the command that runs it."""

    target: str
    command: tuple[str, ...]


@pytest.fixture(scope="session", params=list(CMAKE))
def driver(request: pytest.FixtureRequest) -> Driver:
    target, build = request.param, BUILD / request.param
    cmake, ninja = (str(Path(sys.executable).with_name(name)) for name in ("cmake", "ninja"))
    options = [f"-DCMAKE_{name}={value}" for name, value in CMAKE[target].items()]
    source = ["-S", str(HERE / "other_targets"), "-B", str(build), "-G", "Ninja", f"-DCMAKE_MAKE_PROGRAM={ninja}"]
    for command in ([cmake, *source, "-DCMAKE_BUILD_TYPE=Release", *options], [cmake, "--build", str(build)]):
        done = subprocess.run(command, capture_output=True, text=True, check=False)
        assert done.returncode == 0, done.stdout + done.stderr
    runs = {
        "aarch64": ("qemu-aarch64", "-L", "/usr/aarch64-linux-gnu"),
        "wasm": (str(page.node() / "bin" / "node"), "--no-warnings", str(HERE / "wasm" / "driver.mjs")),
    }
    return Driver(target, (*runs[target], str(build / "driver")))


@pytest.fixture
def calls(monkeypatch: pytest.MonkeyPatch) -> Calls:
    return Calls(monkeypatch)


def require_same_bits(calls: Calls, driver: Driver, folder: Path) -> None:
    """Repeats all calls on the other target."""
    given, found = folder / "calls", folder / "results"
    given.write_bytes(written(calls.kept))
    subprocess.run([*driver.command, str(given), str(found)], check=True, timeout=300)
    for number, (call, there) in enumerate(zip(calls.kept, read(calls.kept, found.read_bytes()), strict=True)):
        for name, here in call.results.items():
            if here.tobytes() == there[name].tobytes():
                continue
            differ = np.argwhere(np.asarray(here != there[name]))
            largest = np.abs(here.astype(np.float64) - there[name]).max()
            raise AssertionError(
                f"call {number}, {call.name}: {name} differs in {len(differ)} of {here.size} values, "
                f"first at {differ[0] if len(differ) else None}, at most by {largest}."
            )


def with_curved_pots(arm: ArmParameters) -> ArmParameters:
    """The last one so short that the arm passes its ends."""
    pots = [pot.model_copy(update={"linearity": 0.02}) for pot in arm.follower_pots.joint]
    pots[3] = pots[3].model_copy(update={"track": 0.4})
    return arm.model_copy(update={"follower_pots": arm.follower_pots.model_copy(update={"joint": tuple(pots)})})


def short_motion() -> Trajectory:
    whole = human_reaches(4, 2.0)
    moved = whole.time_s < MOVES_S
    return Trajectory(whole.time_s[moved], whole.angles[moved])


def experiment(name: str) -> Experiment:
    leader, arm = short_motion(), default_arm()
    if name == "mega":
        return Experiment(leader, arm, wait_s=0.2)
    if name == "nano, no noise, no soft start":
        return Experiment(
            leader, arm, table=ParameterTable.defaults(Board.NANO328), noise=False, soft_start=False, wait_s=0.2
        )
    if name == "curved pots, slow controllers":
        return Experiment(
            leader, with_curved_pots(arm), table=ParameterTable.defaults().with_raw({"period_ms": 5}), wait_s=0.2
        )
    timing = Timing(late=7, chain_start=5000, acts=(1, 2, 3, 1), drivers_on=3)
    return Experiment(leader, load_arm("white_box"), timing=timing, wait_s=0.2)


STEPS_PER_TICK = {
    "mega": (1, 2, 4),
    "nano, no noise, no soft start": (1,),
    "curved pots, slow controllers": (2,),
    "late and off the slice": (4,),
}


SHADOW = -2  # of the candidates


def candidates() -> tuple[Any, Any]:
    """Of four arms; some against a stop all the time, some with short ramps, some that cannot be.

    The last but one is a shadow of an arm: its inertias and torques are so small that many a product is no normal
    number. The last is lost at once.
    """
    boxes = [
        search_box("worn", 5, 0.3, 2),
        search_box("default", 7, 1.0, 1),
        search_box("white_box", 6, 0.4, 3),
        search_box("grey_box", 6, 2.0, 3),
    ]
    controllers, plants = (np.concatenate(parts) for parts in zip(*boxes, strict=True))
    plants[::5, columns("stop_max")] = 0.5
    controllers[3::7, :, CONTROLLER_COLUMNS.index("ze_c")] = 200
    controllers[3::7, :, CONTROLLER_COLUMNS.index("nce_c")] = -300
    plants[-4:-2, column("ixx3")] = 10.0
    lasting = [column("supply")]
    for name in ("stribeck_velocity", "half_gap", "stop_min", "stop_max"):
        lasting += columns(name)
    plants[SHADOW, [place for place in range(len(PLANT_COLUMNS)) if place not in lasting]] *= 1e-35
    plants[-1, columns("torque_per_volt")] *= 1e36
    return controllers, plants


@pytest.mark.parametrize("name", STEPS_PER_TICK)
def test_batch(name: str, calls: Calls, driver: Driver, tmp_path: Path) -> None:
    steps, loop = STEPS_PER_TICK[name], experiment(name)
    controllers, plants = candidates()
    if driver.target == "wasm":  # it cannot take such numbers for 0
        controllers, plants = (np.delete(rows, SHADOW, axis=0) for rows in (controllers, plants))
    results = [loop.run(controllers, plants, every=5, steps_per_tick=number) for number in steps]
    assert [call.name for call in calls.kept] == ["leader_readings"] + ["run"] * len(steps)
    assert name != "mega" or all(result.diverged[-1] for result in results)
    assert all(len(np.unique(result.duties)) > 100 for result in results)
    require_same_bits(calls, driver, tmp_path)


@pytest.mark.parametrize("name", STEPS_PER_TICK)
def test_single_runs(name: str, calls: Calls, driver: Driver, tmp_path: Path) -> None:
    loop = experiment(name)
    controllers, plants = candidates()
    result = loop.run_exact(controllers[::3], plants[::3], every=5)
    loop.run_exact(controllers[1], plants[1], every=5, steps_per_slice=3)
    assert len(np.unique(result.duties)) > 100
    require_same_bits(calls, driver, tmp_path)


def test_identification_windows(calls: Calls, driver: Driver, tmp_path: Path) -> None:
    spacing = 1e-3 * np.random.default_rng(2).uniform(0.5, 1.5, 150)
    for arm in ("default", "white_box", "grey_box", "worn"):
        for count in (1, 3, 5):
            given = windows_of_test(load_arm(arm), count)
            angles = np.asarray(_native.simulate_windows(**given))
            assert np.abs(angles[:, :, -1] - angles[:, :, 0]).max() > 1e-3
            _native.simulate_windows(**(given | {"spacing": spacing, "velocities": np.full((3, 4), 0.5)}))
    require_same_bits(calls, driver, tmp_path)


def test_ideal_law(calls: Calls, driver: Driver, tmp_path: Path) -> None:
    slices = leader_slices(short_motion(), 0.5)
    tunings = np.tile([1.1, 0.02, 1.0, 1.0], (3, 4, 1)) * np.array([1.0, 1.1, 1.2])[:, None, None]
    direction = np.where(np.arange(len(slices)) % 4000 < 1500, 1, 0).astype(np.int8)
    for arm in ("default", "white_box", "worn"):
        for chased in (-1, 1):
            _, angles = _native.simulate_ideal(
                leader=slices,
                late=4,
                plant=plant_row(load_arm(arm)),
                supply=12.0,
                tunings=tunings,
                chased=chased,
                direction=direction,
                until=np.full(len(slices), 0.5),
                keep=True,
                threads=0,
            )
            assert np.ptp(angles) > 0.1
    require_same_bits(calls, driver, tmp_path)


@pytest.mark.parametrize("period_ms", [1, 5])
def test_fuzzy_law_in_lanes(period_ms: int, calls: Calls, driver: Driver, tmp_path: Path) -> None:
    random = np.random.default_rng(period_ms)
    controllers = random_controllers(random, period_ms)
    leader, follower = random_angles(random), random_angles(random)
    limit = random.choice(np.array([0, 100, 5000, 15000, 30000, 32767], dtype=np.uint16), len(leader))
    _native.sixteen_laws(
        controllers=controllers, period_ms=period_ms, leader=leader, follower=follower, limit_mv=limit, instructions=""
    )
    assert len(calls.kept) == 1
    require_same_bits(calls, driver, tmp_path)
