"""The leader arm as LeRobot's teleoperator. The board itself lets the follower follow it, a thousand times a second."""

from __future__ import annotations

from typing import Any

from lerobot.teleoperators import Teleoperator
from lerobot.utils.decorators import check_if_already_connected, check_if_not_connected

from greywhale.base.errors import BadUsage
from lerobot_robot_greywhale.config import GreywhaleLeaderConfig
from lerobot_robot_greywhale.link import Link, Motors
from lerobot_robot_greywhale.part import Part


class GreywhaleLeader(Part, Teleoperator):
    """Angles are in rad. There are no motors in the leader arm, so no feedback either."""

    config_class = GreywhaleLeaderConfig
    name = "greywhale_leader"

    def __init__(self, config: GreywhaleLeaderConfig) -> None:
        super().__init__(config)
        self.config = config
        self._joints = tuple(config.joints)

    @property
    def feedback_features(self) -> dict[str, type]:
        return {}

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
        link = self._linked
        link.given = link.given_now(self._joints)
        return dict(link.given)

    def send_feedback(self, feedback: dict[str, Any]) -> None:
        """Nothing: there is nothing to send."""

    @check_if_not_connected
    def disconnect(self) -> None:
        """End the use of the board; a follower that still follows is stopped first."""
        link, self._link = self._linked, None
        try:
            if link.works:
                link.turn(Motors.OFF)
            link.given = None
        finally:
            link.leave()
