"""Arms at random around a white box, on which a method must prove itself without knowing them."""

from __future__ import annotations

import numpy as np

from greywhale.arm.parameters import ArmParameters


def draw_arm(white: ArmParameters, seed: int) -> ArmParameters:
    """The white box with motor combinations times e^(+-0.9), friction, backlash and sensor noise of its own."""
    random = np.random.default_rng(seed)
    joints = []
    for number, joint in enumerate(white.joint):
        known = white.actuator(number)
        alpha, inertia_volts, damping_volts = random.uniform(-0.9, 0.9, 3)
        torque_per_volt = known.torque_per_volt * np.exp(-alpha)
        inertia = known.inertia * np.exp(inertia_volts - alpha)
        damping = known.damping * np.exp(damping_volts - alpha)
        coulomb = random.uniform(0.2, 0.9) * torque_per_volt
        motor = {
            "gear_ratio": 1.0,
            "torque_constant": 0.5 * damping / torque_per_volt,
            "resistance": 0.5 * damping / torque_per_volt**2,
            "inertia": inertia,
            "viscous": 0.5 * damping,
        }
        stiffness = 15.0 * torque_per_volt / 0.004
        joints.append(
            joint.model_dump()
            | {
                "motor": {key: float(value) for key, value in motor.items()},
                "friction": {
                    "coulomb": float(coulomb),
                    "breakaway": float(coulomb * random.uniform(1.05, 1.5)),
                    "stribeck_velocity": float(random.uniform(0.05, 0.15)),
                },
                "gear": {
                    "half_gap": float(random.uniform(0.001, 0.006)),
                    "stiffness": float(stiffness),
                    "damping": float(stiffness * 0.002),
                    "drag": float(0.02 * damping),
                },
            }
        )
    noise = float(random.uniform(0.001, 0.004))
    pots = {"supply": 5.0, "joint": [{"noise": noise}] * 4}
    data = white.model_dump() | {"name": f"random arm {seed}", "joint": joints, "motor_equation": "physical"}
    return ArmParameters.model_validate(data | {"follower_pots": pots, "leader_pots": pots}, strict=False)
