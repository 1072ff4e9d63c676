"""Effects of use: friction that grows with load, creep, a sagging supply, play and lag at the pots.

Each is compared with a formula, or with an integration by SciPy of the same physics written down anew.
"""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest
from scipy.integrate import solve_ivp

from greywhale.arm import Arm, PotentiometerBank, Potentiometers
from greywhale.arm.parameters import Potentiometer
from greywhale.base.types import Floats

SLICE_S = 0.25e-3
ROLL = 3  # with the arm level, roll moves by itself: no gravity, no other joint
MOTOR = {"inertia": 0.01, "resistance": 2.0, "torque_constant": 0.5, "viscous": 0.02, "gear_ratio": 1.0}


def roll_arm(make_arm: Any, friction: dict[str, float], gear: dict[str, float], **changes: Any) -> Any:
    joint = {"motor": MOTOR, "friction": friction, "gear": gear}
    return make_arm(gravity=0.0, joint_3=joint, **changes)


@pytest.mark.slow
def test_load_friction_moves_as_an_independent_integration_says(make_arm: Any) -> None:
    """A spring between motor and link, driven to and fro, with an outside load that the gear must pass on."""
    share = 0.5
    friction = {"coulomb": 0.05, "breakaway": 0.05, "load": share}
    gear = {"half_gap": 0.0, "stiffness": 20.0, "damping": 0.05, "drag": 0.0}
    parameters = roll_arm(make_arm, friction, gear)
    actuator, link = parameters.actuator(ROLL), parameters.link[3].inertia.xx
    load = 0.1

    def volts(t: float) -> float:
        return float(3.0 * np.sin(12.0 * np.floor(t / 0.01) * 0.01))

    def rates(t: float, s: Floats) -> list[float]:
        motor_q, motor_v, q, v = s
        passed = gear["stiffness"] * (motor_q - q) + gear["damping"] * (motor_v - v)
        dry = (friction["coulomb"] + share * abs(passed)) * np.tanh(motor_v / 2e-4)
        torque = actuator.torque_per_volt * volts(t) - actuator.damping * motor_v - passed - dry
        return [motor_v, torque / actuator.inertia, v, (passed + load) / link]

    arm = Arm(parameters, longest_step_s=1e-5)
    arm.set_load([0.0, 0.0, 0.0, load])
    ours, theirs, state = [], [], np.zeros(4)
    for step in range(100):
        begin = 0.01 * step
        arm.step([0.0, 0.0, 0.0, volts(begin + 1e-6)], 0.01)
        ours.append(arm.angles[ROLL])
        found = solve_ivp(rates, (begin, begin + 0.01 - 1e-9), state, method="Radau", rtol=1e-7, atol=1e-10)
        state = found.y[:, -1]
        theirs.append(state[2])
    swing = np.ptp(theirs)
    assert swing > 0.1
    assert np.abs(np.array(ours) - np.array(theirs)).max() < 5e-3 * swing


def test_load_friction_holds_what_would_slide(make_arm: Any, rigid: Any) -> None:
    """The load needs more than the breakaway torque, but friction grows with it; half as much does not hold."""
    for share, holds in ((0.7, True), (0.3, False)):
        parameters = roll_arm(make_arm, {"coulomb": 0.1, "breakaway": 0.1, "load": share}, rigid["gear"])
        arm = Arm(parameters)
        arm.set_load([0.0, 0.0, 0.0, 0.3])
        arm.step(np.zeros(4), 0.5)
        assert (abs(arm.angles[ROLL]) < 1e-12) == holds


@pytest.mark.parametrize("teeth", [0.0, 50.0])
def test_creep_is_a_speed_in_proportion_to_the_torque(make_arm: Any, teeth: float) -> None:
    gear = {"half_gap": 0.0, "stiffness": teeth, "damping": 0.01 * teeth, "drag": 0.0}
    parameters = roll_arm(make_arm, {"coulomb": 0.1, "breakaway": 0.2, "creep_velocity": 0.02}, gear)
    actuator = parameters.actuator(ROLL)
    resistance = 0.2 / 0.02 + actuator.damping
    for share in (-0.9, 0.3, 0.6, 0.95):
        arm = Arm(parameters)
        arm.step([0.0, 0.0, 0.0, share * 0.2 / actuator.torque_per_volt], 1.0)
        assert arm.motor_velocities[ROLL] == pytest.approx(share * 0.2 / resistance, rel=1e-6)
        assert arm.unsettled_steps == 0
    arm = Arm(parameters)
    arm.step([0.0, 0.0, 0.0, 1.05 * 0.2 / actuator.torque_per_volt], 1.0)
    assert arm.motor_velocities[ROLL] > 0.1


def test_supply_sags_as_its_circuit_says(make_arm: Any, rigid: Any) -> None:
    """One motor starts from rest. The circuit V = V0 - Rs d i, i = (d V - Ke w) / R gives its torque at every speed."""
    friction = {"coulomb": 0.0, "breakaway": 0.0}
    supply, resistance, driver = 12.0, 0.8, 0.4
    drive = {"supply": supply, "supply_resistance": resistance, "resistance": driver}
    parameters = roll_arm(make_arm, friction, rigid["gear"], drive=drive)
    constant, total = MOTOR["torque_constant"], MOTOR["resistance"] + driver
    inertia = MOTOR["inertia"] + parameters.link[3].inertia.xx
    for duty in (1.0, 0.6, -0.3):

        def rate(_: float, state: Floats, duty: float = duty) -> list[float]:
            left = (supply + resistance * duty * constant * state[1] / total) / (1.0 + resistance * duty**2 / total)
            current = (duty * left - constant * state[1]) / total
            return [state[1], (constant * current - MOTOR["viscous"] * state[1]) / inertia]

        arm = Arm(parameters, longest_step_s=2e-5)
        arm.step([0.0, 0.0, 0.0, duty * supply], 0.1)
        found = solve_ivp(rate, (0.0, 0.1), [0.0, 0.0], rtol=1e-9, atol=1e-12)
        assert arm.angles[ROLL] == pytest.approx(found.y[0, -1], rel=1e-3)
        assert abs(found.y[0, -1]) < 2.0


def test_braking_motor_feeds_the_others(make_arm: Any, rigid: Any) -> None:
    """A motor that runs against its voltage gives current back, which lifts the voltage that another one gets."""
    friction = {"coulomb": 0.0, "breakaway": 0.0}
    parameters = roll_arm(make_arm, friction, rigid["gear"], drive={"supply": 12.0, "supply_resistance": 1.0})
    pushed, still = Arm(parameters), Arm(parameters)
    pushed.set_load([3.0, 0.0, 0.0, 0.0])
    for arm in (pushed, still):
        arm.step(np.zeros(4), 0.1)
        arm.step([1.0, 0.0, 0.0, 6.0], 0.02)
    assert pushed.velocities[0] > 1.0
    assert pushed.velocities[ROLL] > 1.001 * still.velocities[ROLL]


def test_a_driver_keeps_its_volts_by_the_direction_of_the_voltage(make_arm: Any, rigid: Any) -> None:
    """A smaller voltage does nothing; a larger one moves as what is left of it moves an arm that loses none."""
    friction, losses = {"coulomb": 0.0, "breakaway": 0.0}, {"lost_up": 0.4, "lost_down": 0.1}
    sound = roll_arm(make_arm, friction, rigid["gear"])
    joint = {"motor": MOTOR, "friction": friction, "gear": rigid["gear"], "driver": losses}
    lossy = make_arm(gravity=0.0, joint_3=joint)
    for asked, acting in ((0.39, 0.0), (-0.09, 0.0), (1.0, 0.6), (-1.0, -0.9)):
        one, other = Arm(lossy), Arm(sound)
        one.step([0.0, 0.0, 0.0, asked], 0.1)
        other.step([0.0, 0.0, 0.0, acting], 0.1)
        assert one.angles[ROLL] == pytest.approx(other.angles[ROLL], abs=1e-15)


def pots(**values: float) -> Potentiometers:
    return Potentiometers(PotentiometerBank(joint=(Potentiometer(**values),) * 4))  # type: ignore[arg-type]


def read(sensor: Potentiometers, angles: Floats) -> Floats:
    """Shown angles (rad) of a motion of all joints, slice by slice."""
    volts = np.array([sensor.millivolts(np.full(4, angle))[0] for angle in angles])
    return np.asarray((volts / 5000.0 - 0.5) * np.radians(300.0), dtype=np.float64)


def test_play_drags_the_wiper_at_its_ends_only() -> None:
    there_and_back: Floats = np.concatenate([np.linspace(0.0, 0.3, 301), np.linspace(0.3, 0.0, 301)])
    shown = read(pots(play=0.05), there_and_back)
    np.testing.assert_allclose(shown[:301], np.maximum(there_and_back[:301] - 0.05, 0.0), atol=1e-12)
    np.testing.assert_allclose(shown[301:], np.minimum(0.25, there_and_back[301:] + 0.05), atol=1e-12)


def test_lag_delays_a_ramp_by_its_time_constant_and_smooths_a_sine_by_its_gain() -> None:
    lag, time = 2e-3, np.arange(4000) * SLICE_S
    ramp = read(pots(lag=lag), np.asarray(0.5 * time, dtype=np.float64))
    np.testing.assert_allclose(ramp[200:], 0.5 * (time[200:] - lag), atol=1e-7)
    rate = 2 * np.pi * 40.0
    sine = read(pots(lag=lag), 0.1 * np.sin(rate * time))[400:]
    gain, phase = 1 / np.hypot(1.0, rate * lag), np.arctan(rate * lag)
    np.testing.assert_allclose(sine, 0.1 * gain * np.sin(rate * time[400:] - phase), atol=0.1 * 2e-3)
