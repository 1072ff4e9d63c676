"""The exported arm in Pinocchio and MuJoCo, two engines that share no code with greywhale."""

from __future__ import annotations

import mujoco
import numpy as np
import pinocchio

from greywhale.arm import ArmParameters
from greywhale.arm.export import mjcf, urdf
from greywhale.files.arm import default_arm

TIP_MASS = 0.07  # kg, so that the tip's terms are in the comparison


def arm_with_tip() -> ArmParameters:
    arm = default_arm()
    return arm.model_copy(update={"tip": arm.tip.model_copy(update={"mass": TIP_MASS})})


def without(arm: ArmParameters, used: tuple[int, ...]) -> ArmParameters:
    """A copy of the arm with all but these joints rigid."""
    joints = tuple(one.model_copy(update={"fixed": n not in used}) for n, one in enumerate(arm.joint))
    return arm.model_copy(update={"joint": joints})


def random_states(count: int, seed: int) -> tuple[np.ndarray, np.ndarray]:
    rng = np.random.default_rng(seed)
    return rng.uniform(-np.pi, np.pi, (count, 4)), rng.uniform(-8, 8, (count, 4))


class Pinocchio:
    def __init__(self, text: str) -> None:
        self.model = pinocchio.buildModelFromXML(text)
        self.data = self.model.createData()

    @classmethod
    def of(cls, parameters: ArmParameters) -> Pinocchio:
        return cls(urdf(parameters))

    def mass_matrix(self, q: np.ndarray) -> np.ndarray:
        upper = np.triu(pinocchio.crba(self.model, self.data, q))
        return upper + np.triu(upper, 1).T

    def bias(self, q: np.ndarray, v: np.ndarray) -> np.ndarray:
        return np.array(pinocchio.rnea(self.model, self.data, q, v, np.zeros(len(q))))


class MuJoCo:
    def __init__(self, parameters: ArmParameters) -> None:
        self.model = mujoco.MjModel.from_xml_string(mjcf(parameters))
        self.model.dof_armature[:] = 0.0  # the links alone
        self.data = mujoco.MjData(self.model)

    def _place(self, q: np.ndarray, v: np.ndarray) -> None:
        self.data.qpos[:] = q
        self.data.qvel[:] = v
        mujoco.mj_forward(self.model, self.data)

    def mass_matrix(self, q: np.ndarray) -> np.ndarray:
        self._place(q, np.zeros(len(q)))
        full = np.zeros((len(q), len(q)))
        for column, unit in enumerate(np.eye(len(q))):
            mujoco.mj_mulM(self.model, self.data, full[column], unit)
        return full

    def bias(self, q: np.ndarray, v: np.ndarray) -> np.ndarray:
        self._place(q, v)
        return self.data.qfrc_bias.copy()
