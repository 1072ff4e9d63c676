"""Arms that greywhale's model does not know, and how they follow before and after a commissioning in lock step.

MuJoCo moves them, and their potentiometers have play behind the joint.
"""

from __future__ import annotations

import time
from collections.abc import Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import Any
from xml.etree import ElementTree as xml

import numpy as np
import numpy.typing as npt

from greywhale.arm import ArmParameters
from greywhale.arm.export import mjcf
from greywhale.base.types import Floats
from greywhale.cli.story import RunningBench, record_motion
from greywhale.cli.story.recorder import HuntedError
from greywhale.commission import CommissioningRequest, commission
from greywhale.commission.result import CommissioningResult
from greywhale.files.arm import load_arm
from greywhale.files.leader import save_leader
from greywhale.files.model import arm_toml
from greywhale.files.trajectory import Trajectory
from greywhale.measure import evaluate
from greywhale.measure.swings import ripple_at_rest, unrest
from greywhale.protocol.firmware import JOINTS, TICK_S
from greywhale_sim.assemble import BenchOptions, build_bench
from greywhale_sim.lockstep import LockStepBench

MASS, MOTOR = 0.1, 0.6  # masses are off by this share, motors by this logarithm, both uniform
FRICTION_V = (0.15, 0.9)
PLAY_RAD = (0.002, 0.020)  # of the whole band
NOISE_V = (0.001, 0.004)
STILL_RAD = 0.02  # a leader's potentiometer at rest shows this much


@dataclass(frozen=True)
class ForeignArm:
    """Masses, motors and friction of an arm, and the play (4,) rad between each joint and its potentiometer."""

    parameters: ArmParameters
    play: Floats


def foreign_arm(seed: int) -> ForeignArm:
    """The white box with masses, motors, friction, noise and play of its own; rigid gears, no Stribeck friction."""
    random = np.random.default_rng(7000 + seed)
    white = load_arm("white_box")
    links = []
    for link in white.link:
        factor = float(np.exp(random.uniform(-MASS, MASS)))
        inertia = {key: factor * value for key, value in link.inertia.model_dump().items()}
        links.append(link.model_dump() | {"mass": factor * link.mass, "inertia": inertia})
    joints = []
    for number, joint in enumerate(white.joint):
        known = white.actuator(number)
        alpha, inertia_volts, damping_volts = random.uniform(-MOTOR, MOTOR, 3)
        torque_per_volt = float(known.torque_per_volt * np.exp(-alpha))
        damping = float(known.damping * np.exp(damping_volts - alpha))
        motor = {
            "gear_ratio": 1.0,
            "torque_constant": 0.5 * damping / torque_per_volt,
            "resistance": 0.5 * damping / torque_per_volt**2,
            "inertia": float(known.inertia * np.exp(inertia_volts - alpha)),
            "viscous": 0.5 * damping,
        }
        coulomb = float(random.uniform(*FRICTION_V)) * torque_per_volt
        joints.append(joint.model_dump() | {"motor": motor, "friction": {"coulomb": coulomb, "breakaway": coulomb}})
    noise = float(random.uniform(*NOISE_V))
    pots = {"supply": 5.0, "joint": [{"noise": noise}] * JOINTS}
    data = white.model_dump() | {"name": f"foreign arm {seed}", "link": links, "joint": joints}
    data |= {"motor_equation": "physical", "follower_pots": pots, "leader_pots": pots}
    return ForeignArm(ArmParameters.model_validate(data, strict=False), random.uniform(*PLAY_RAD, JOINTS))


class MuJoCoPlant:
    """The follower of a bench: `step` turns voltages into the angles that the potentiometers show."""

    def __init__(self, arm: ForeignArm) -> None:
        import mujoco  # only `make oracles` installs it

        self._engine: Any = mujoco
        self._half = 0.5 * arm.play
        self._shown = np.zeros(JOINTS)
        self._load(arm.parameters)

    def _load(self, parameters: ArmParameters) -> None:
        self._model: Any = self._engine.MjModel.from_xml_string(_as_soft_as_usual(mjcf(parameters)))
        self._model.opt.integrator = self._engine.mjtIntegrator.mjINT_IMPLICITFAST
        self._data: Any = self._engine.MjData(self._model)

    def become(self, parameters: ArmParameters) -> None:
        """Have other parameters from now on, in the middle of a movement."""
        before = self._data
        self._load(parameters)
        self._data.qpos[:], self._data.qvel[:] = before.qpos, before.qvel

    def reset(self, angles: Floats) -> None:
        """Hold the arm in a pose by hand."""
        self._data.qpos[:] = angles
        self._data.qvel[:] = 0.0
        self._shown = angles.copy()

    def step(self, voltages: Floats, dt: float) -> Floats:
        self._model.opt.timestep = dt
        self._data.ctrl[:] = voltages
        self._engine.mj_step(self._model, self._data)
        # The joint drags the wiper along at either end of the play.
        self._shown = np.clip(self._shown, self._data.qpos - self._half, self._data.qpos + self._half)
        return self._shown


def _as_soft_as_usual(text: str) -> str:
    """The exported arm with friction and stops as MuJoCo has them by default: softer than this arm's own."""
    root = xml.fromstring(text)
    (default,) = root.findall("default")
    default.remove(default.findall("joint")[0])
    return xml.tostring(root, encoding="unicode")


def save(arm: ForeignArm, path: Path) -> Path:
    """Write the arm file that a bench needs for potentiometers and supply."""
    path.write_text(arm_toml(arm.parameters, "An arm of another engine."), encoding="utf-8")
    return path


def bench_of(arm: ForeignArm, folder: Path) -> LockStepBench:
    """A bench in lock step with that arm on it."""
    options = BenchOptions(arm=save(arm, folder / "foreign.toml"))
    return LockStepBench(options, build_bench(options, MuJoCoPlant(arm)))


@dataclass(frozen=True)
class Run:
    """Errors (4,) rad², and unrest (4,) rad rms and ripple (4,) V rms at rest, by motion."""

    error: dict[str, Floats]
    unrest: dict[str, Floats]
    ripple: dict[str, Floats]


@dataclass(frozen=True)
class Commissioned:
    """An arm's following of unseen motions before and after, the sets tried in between, and its wall time (s)."""

    before: Run
    after: Run
    outcome: CommissioningResult
    wall_s: float

    @property
    def kept(self) -> npt.NDArray[np.bool_]:
        """(4,): joints that keep their controllers from before."""
        same: npt.NDArray[np.bool_] = (self.outcome.best.rows == self.outcome.trials.before.rows).all(axis=1)
        return same


def commissioned(bench: RunningBench, folder: Path, unseen: Mapping[str, Trajectory], **options: Any) -> Commissioned:
    """Commission the arm on this bench."""
    before = recorded(bench, folder, "before", unseen)
    started = time.monotonic()
    outcome = commission(CommissioningRequest(port=bench.port, out=folder / "commission", **options))
    wall = time.monotonic() - started
    return Commissioned(before, recorded(bench, folder, "after", unseen), outcome, wall)


def recorded(bench: RunningBench, folder: Path, when: str, unseen: Mapping[str, Trajectory]) -> Run:
    """Every motion with the controllers that the board has; infinite where the board ended it for its unrest."""
    errors, rests, ripples = {}, {}, {}
    for name, motion in unseen.items():
        leader = folder / "leader.csv"
        save_leader(leader, motion)
        try:
            log = record_motion(bench, leader, folder / f"{when} {name}.csv").log()
        except HuntedError:
            errors[name] = rests[name] = ripples[name] = np.full(JOINTS, np.inf)
            continue
        errors[name] = np.array([joint.mse for joint in evaluate(log).joints])
        grid = np.arange(0.0, float(log.time[-1]), TICK_S)
        led, followed, voltage = (
            np.column_stack([np.interp(grid, log.time, values[:, joint]) for joint in range(JOINTS)])
            for values in (log.leader, log.follower, log.voltage)
        )
        rests[name] = unrest(led, followed, STILL_RAD)
        ripples[name] = ripple_at_rest(led, voltage, STILL_RAD)
    return Run(errors, rests, ripples)
