"""The part that robot and teleoperator have alike: joints, a link, and a board that keeps its calibration itself."""

from __future__ import annotations

from functools import cached_property

from greywhale.files.exchange.lerobot_frames import names_of
from greywhale.protocol.joints import Joints
from lerobot_robot_greywhale.link import Link


class Part:
    """Comes before LeRobot's own class among the bases, whose abstract methods these are."""

    _joints: Joints
    _link: Link | None = None

    @cached_property
    def action_features(self) -> dict[str, type]:
        return dict.fromkeys(names_of(self._joints, "pos"), float)

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

    @property
    def _linked(self) -> Link:
        assert self._link is not None
        return self._link
