"""The follower as LeRobot's robot: it follows the leader arm of its board, or, without that, what actions say."""

from __future__ import annotations

import contextlib
from functools import cached_property
from typing import Any

import numpy as np
from lerobot.cameras import make_cameras_from_configs
from lerobot.robots import Robot
from lerobot.utils.decorators import check_if_already_connected, check_if_not_connected

from greywhale.base.errors import BadUsage, UserError
from greywhale.files.exchange.lerobot_frames import names_of
from greywhale.protocol.firmware import ANGLE_LSB, FASTEST_LED_RAD_S
from greywhale.protocol.schema import Sample
from lerobot_robot_greywhale.config import GreywhaleConfig
from lerobot_robot_greywhale.link import Link, Motors
from lerobot_robot_greywhale.part import Part

# An action that says what the leader said differs from that by rounding alone, rad.
_SAME_RAD = 1e-3


class Greywhale(Part, Robot):
    """Angles are in rad, voltages in V. The calibration is on the board: `greywhale calibrate`."""

    config_class = GreywhaleConfig
    name = "greywhale"

    def __init__(self, config: GreywhaleConfig) -> None:
        super().__init__(config)
        if not 0.0 < config.max_speed <= FASTEST_LED_RAD_S:
            raise BadUsage(
                f"--robot.max_speed is {config.max_speed:g} rad/s; it must be above 0 and at most "
                f"{FASTEST_LED_RAD_S:.3g} rad/s."
            )
        self.config = config
        self.cameras: dict[str, Any] = make_cameras_from_configs(config.cameras)
        self._joints = tuple(config.joints)
        self._angles, self._volts = names_of(self._joints, "pos"), names_of(self._joints, "voltage")

    @cached_property
    def observation_features(self) -> dict[str, Any]:
        pictures = {name: (one.height, one.width, 3) for name, one in self.cameras.items()}
        return {**dict.fromkeys([*self._angles, *self._volts], float), **pictures}

    @check_if_already_connected
    def connect(self, calibrate: bool = True) -> None:
        """Turn the motors on. A teleoperator of this board must be connected before: then its leader arm leads."""
        self._link = Link.join(self.config.port, self._joints)
        try:
            self._link.speed = self.config.max_speed
            for camera in self.cameras.values():
                camera.connect()
            self._link.turn(Motors.LEAD if self._link.given is None else Motors.FOLLOW)
        except BaseException:
            self.disconnect()
            raise

    @check_if_not_connected
    def get_observation(self) -> dict[str, Any]:
        sample = self._linked.sample()
        angles = [sample.follower[joint] * ANGLE_LSB for joint in self._joints]
        volts = [sample.voltage[joint] * Sample.LSB["voltage"] for joint in self._joints]
        pictures = {name: one.read_latest() for name, one in self.cameras.items()}
        return {**dict(zip([*self._angles, *self._volts], [*angles, *volts], strict=True)), **pictures}

    @check_if_not_connected
    def send_action(self, action: dict[str, float]) -> dict[str, float]:
        """Lead to the action's angles, and return those within the joints' limits. While the leader arm leads, the
        action must be what that said last, and what it says now is returned.
        """
        link = self._linked
        try:
            wanted = np.array([float(action[name]) for name in self._angles])
        except KeyError as missing:
            raise UserError(f"the action has no {missing}; it must have {', '.join(self._angles)}.") from None
        if not np.isfinite(wanted).all():
            raise UserError(f"the action has an angle that is no number: {wanted.tolist()}; the arm stays where it is.")
        if link.motors is Motors.FOLLOW:
            assert link.given is not None
            if np.abs(wanted - [link.given[name] for name in self._angles]).max() > _SAME_RAD:
                raise UserError(
                    "the action is not what greywhale_leader said, but the follower follows that arm by itself; "
                    "leave the teleoperator out, so that actions lead."
                )
            return link.given_now(self._joints)
        if link.motors is not Motors.LEAD:
            raise UserError("the motors went off with greywhale_leader; connect that and the robot again.")
        low, high = link.limits[:, list(self._joints)]
        sent = np.clip(wanted, low, high)
        goal = np.zeros(link.limits.shape[1])
        goal[list(self._joints)] = sent
        link.lead_to(goal)
        return dict(zip(self._angles, sent.tolist(), strict=True))

    @check_if_not_connected
    def disconnect(self) -> None:
        """Turn the motors off. What ended the link before has been told by the call that found it."""
        link, self._link = self._linked, None
        with contextlib.ExitStack() as last:
            last.callback(link.leave)
            for camera in self.cameras.values():
                if camera.is_connected:
                    last.callback(camera.disconnect)
            if link.works:
                link.turn(Motors.OFF)
