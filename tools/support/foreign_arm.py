"""Arms that greywhale's model does not know, and how they follow before and after a commissioning in lock step.

MuJoCo moves them, and their potentiometers have play behind the joint. `TRAITS` names what an arm may have besides:
gears with two masses, flexible joints, drivers that lose volts, cogging, a heavy or a feeble arm.
"""

from __future__ import annotations

import time
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from pathlib import Path
from typing import Any
from xml.etree import ElementTree as xml

import numpy as np
import numpy.typing as npt

from greywhale.arm import ArmParameters
from greywhale.arm.export import mjcf
from greywhale.base.types import Floats
from greywhale.board.device import Device
from greywhale.board.upload import upload_controller
from greywhale.cli.story import RunningBench, record_motion
from greywhale.cli.story.learn import Learnt, learn
from greywhale.cli.story.practice import UNTUNED, practise, tables
from greywhale.cli.story.recorder import StoppedError
from greywhale.commission import CommissioningRequest, commission
from greywhale.commission.result import CommissioningResult
from greywhale.files.arm import load_arm
from greywhale.files.leader import save_leader
from greywhale.files.model import arm_toml
from greywhale.files.paper_tables import paper_table
from greywhale.files.trajectory import Trajectory
from greywhale.measure import evaluate
from greywhale.measure.swings import ripple_at_rest, unrest
from greywhale.protocol.firmware import JOINTS, TICK_S
from greywhale.protocol.table import ParameterTable
from greywhale_sim.assemble import BenchOptions, build_bench
from greywhale_sim.lockstep import LockStepBench
from tools.support.foreign_gears import SUBSTEPS, Drivers, Gears, inertia_of_joints, with_rotors

MASS, MOTOR = 0.1, 0.6  # masses are off by this share, motors by this logarithm, both uniform
FRICTION_V = (0.15, 0.9)
PLAY_RAD = (0.002, 0.020)  # of the whole band
NOISE_V = (0.001, 0.004)
STILL_RAD = 0.02  # a leader's potentiometer at rest shows this much


# An arm may have, besides: motors apart from their joints by a gap, or by teeth that bend; drivers that lose volts,
# more in one direction; motors that cog; links that weigh three times as much; motors with a third of the torque.
TRAITS = ("two-masses", "flexible", "dead-time", "cogging", "heavy", "feeble")
HALF_GAP_RAD = (0.002, 0.010)
CONTACT_HZ, FLEXIBLE_HZ = (40.0, 80.0), (8.0, 15.0)  # of the joint on its teeth, the motor held
CONTACT_DAMPING, FLEXIBLE_DAMPING = 0.1, 0.03  # of the critical one
LOST_V, LOST_LESS = 0.4, (0.2, 0.8)  # in one direction; a share of it in the other
COGGING_V, POLES = (0.2, 0.5), (24, 60)
HEAVIER, FEEBLER = 3.0, 1.0 / 3.0
CARRIED_POSE_RAD = (0.0, 0.4, 0.0, 0.0)


@dataclass(frozen=True)
class ForeignArm:
    """Masses, motors and friction of an arm, the play (4,) rad between each joint and its potentiometer, and traits."""

    parameters: ArmParameters
    play: Floats
    gears: Gears | None = None  # None: rigid
    drivers: Drivers | None = None  # None: ideal


def foreign_arm_with(seed: int, traits: Sequence[str] = ()) -> ForeignArm:
    """A foreign arm that has these of the `TRAITS`; ValueError for another."""
    unknown = set(traits) - set(TRAITS)
    if unknown:
        raise ValueError(f"no arm can be {sorted(unknown)}; there are {', '.join(TRAITS)}")
    arm, random = foreign_arm(seed), np.random.default_rng(7500 + seed)
    share, hertz = random.uniform(*LOST_LESS, JOINTS), random.uniform(0.0, 1.0, JOINTS)
    half_gap, poles = random.uniform(*HALF_GAP_RAD, JOINTS), random.integers(*POLES, JOINTS).astype(np.float64)
    cogging, side = random.uniform(*COGGING_V, JOINTS), random.integers(0, 2, JOINTS) == 1
    data = arm.parameters.model_dump()
    if "heavy" in traits:
        data["gravity"] *= HEAVIER
    if "feeble" in traits:
        for joint in data["joint"]:
            joint["motor"]["resistance"] /= FEEBLER
    parameters = ArmParameters.model_validate(data, strict=False)
    gears = _gears(parameters, half_gap, hertz, traits) if {"two-masses", "flexible"} & set(traits) else None
    lost = np.where(side, 1.0, share) * LOST_V, np.where(side, share, 1.0) * LOST_V
    if "dead-time" not in traits:
        lost = np.zeros(JOINTS), np.zeros(JOINTS)
    drivers = Drivers(*lost, cogging if "cogging" in traits else np.zeros(JOINTS), poles)
    return replace(arm, parameters=parameters, gears=gears, drivers=drivers)


def _gears(parameters: ArmParameters, half_gap: Floats, shares: Floats, traits: Sequence[str]) -> Gears:
    """Flexible joints bend, gears with two masses have a gap and stiff teeth; with both traits they have both."""
    import mujoco  # only `make oracles` installs it

    carried = inertia_of_joints(mujoco, parameters, np.array(CARRIED_POSE_RAD))
    bends = "flexible" in traits
    (low, high), damped = (FLEXIBLE_HZ, FLEXIBLE_DAMPING) if bends else (CONTACT_HZ, CONTACT_DAMPING)
    turning = 2.0 * np.pi * (low + shares * (high - low))
    gap = half_gap if "two-masses" in traits else np.zeros(JOINTS)
    return Gears(gap, carried * turning**2, 2.0 * damped * carried * turning)


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
        self._gears, self._drivers = arm.gears, arm.drivers
        self._shown, self._pushed = np.zeros(JOINTS), np.zeros(JOINTS)
        self._load(arm.parameters)

    def _load(self, parameters: ArmParameters) -> None:
        text = mjcf(parameters) if self._gears is None else with_rotors(parameters)
        self._model: Any = self._engine.MjModel.from_xml_string(_as_soft_as_usual(text))
        self._model.opt.integrator = self._engine.mjtIntegrator.mjINT_IMPLICITFAST
        self._data: Any = self._engine.MjData(self._model)

    def become(self, parameters: ArmParameters) -> None:
        """Have other parameters from now on, in the middle of a movement."""
        before = self._data
        self._load(parameters)
        self._data.qpos[:], self._data.qvel[:] = before.qpos, before.qvel

    def reset(self, angles: Floats) -> None:
        """Hold the arm in a pose by hand."""
        self._data.qpos[:] = angles if self._gears is None else np.tile(angles, 2)
        self._data.qvel[:] = 0.0
        self._shown = angles.copy()

    def push(self, torques: Floats) -> None:
        """Push on the joints, N m (4,), from now on."""
        self._pushed = torques.copy()

    def step(self, voltages: Floats, dt: float) -> Floats:
        data, gears = self._data, self._gears
        if self._drivers is not None:
            voltages = self._drivers.volts(voltages, data.qpos[-JOINTS:])  # of the motors, where they are apart
        data.ctrl[:] = voltages
        data.qfrc_applied[:JOINTS] = self._pushed
        if gears is None:
            self._model.opt.timestep = dt
            self._engine.mj_step(self._model, data)
        else:
            self._model.opt.timestep = dt / SUBSTEPS
            for _ in range(SUBSTEPS):
                data.qfrc_applied[:] = gears.pushes(data.qpos, data.qvel)
                data.qfrc_applied[:JOINTS] += self._pushed
                self._engine.mj_step(self._model, data)
        # The joint drags the wiper along at either end of the play.
        angles = data.qpos[:JOINTS]
        self._shown = np.clip(self._shown, angles - self._half, angles + self._half)
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


def tuned(bench: RunningBench, folder: Path, unseen: Mapping[str, Trajectory]) -> tuple[Learnt, Run]:
    """Tune alone, from practice as `greywhale demo` makes it: its result, and how the arm follows with it.

    The board has the controllers from before again when this ends.
    """
    nominal, base = load_arm("white_box"), ParameterTable.defaults()
    logs = practise(bench, nominal, base, folder).logs
    learnt = learn(logs[0], logs[1:], tables(base), nominal, folder)
    run = recorded(bench, folder, "tuned", unseen, learnt.controller)
    with Device(bench.port) as device:
        upload_controller(device, paper_table(UNTUNED))
    return learnt, run


def recorded(
    bench: RunningBench, folder: Path, when: str, unseen: Mapping[str, Trajectory], controller: Path | None = None
) -> Run:
    """Every motion with this controller, else with what the board has; infinite where the board ended it for
    how the arm moved.
    """
    errors, rests, ripples = {}, {}, {}
    for name, motion in unseen.items():
        leader = folder / "leader.csv"
        save_leader(leader, motion)
        try:
            log = record_motion(bench, leader, folder / f"{when} {name}.csv", controller).log()
        except StoppedError:
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
