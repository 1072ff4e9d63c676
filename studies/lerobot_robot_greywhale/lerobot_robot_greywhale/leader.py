"""The leader arm as LeRobot's teleoperator. The board itself lets the follower follow it, a thousand times a second."""

from __future__ import annotations

from functools import cached_property
from typing import Any

from lerobot.teleoperators import Teleoperator
from lerobot.utils.decorators import check_if_already_connected, check_if_not_connected

from greywhale.base.errors import BadUsage
from greywhale.files.exchange.lerobot_frames import names_of
from lerobot_robot_greywhale.config import GreywhaleLeaderConfig
from lerobot_robot_greywhale.link import Link, Motors


class GreywhaleLeader(Teleoperator):
    """Angles are in rad. There are no motors in the leader arm, so no feedback either."""

    config_class = GreywhaleLeaderConfig
    name = "greywhale_leader"

    def __init__(self, config: GreywhaleLeaderConfig) -> None:
        super().__init__(config)
        self.config = config
        self._joints = tuple(config.joints)
        self._link: Link | None = None

    @cached_property
    def action_features(self) -> dict[str, type]:
        return dict.fromkeys(names_of(self._joints, "pos"), float)

    @property
    def feedback_features(self) -> dict[str, type]:
        return {}

    @property
    def is_connected(self) -> bool:
        return self._link is not None

    @property
    def is_calibrated(self) -> bool:
        return True

    def calibrate(self) -> None:
        """The board keeps its calibration."""

    def configure(self) -> None:
        """The board keeps its parameters."""

    @check_if_already_connected
    def connect(self, calibrate: bool = True) -> None:
        """Open the board, motors off. Only before its robot, which then follows this arm."""
        link = Link.join(self.config.port, self._joints)
        try:
            if link.motors is Motors.LEAD:
                raise BadUsage(
                    f"{link.device.port}: actions lead the arm already; connect greywhale_leader before the robot."
                )
            link.given = link.given_now(self._joints)
        except BaseException:
            link.leave()
            raise
        self._link = link

    @check_if_not_connected
    def get_action(self) -> dict[str, float]:
        assert self._link is not None
        self._link.given = self._link.given_now(self._joints)
        return dict(self._link.given)

    def send_feedback(self, feedback: dict[str, Any]) -> None:
        """Nothing: there is nothing to send."""

    @check_if_not_connected
    def disconnect(self) -> None:
        """End the use of the board; a follower that still follows is stopped first."""
        assert self._link is not None
        link, self._link = self._link, None
        try:
            if link.works:
                link.turn(Motors.OFF)
            link.given = None
        finally:
            link.leave()
