"""The settings of both, as LeRobot's command line takes them: --robot.port, --teleop.joints."""

from __future__ import annotations

from dataclasses import dataclass, field

from lerobot.cameras import CameraConfig
from lerobot.robots import RobotConfig
from lerobot.teleoperators import TeleoperatorConfig

from greywhale.protocol.joints import ALL


@RobotConfig.register_subclass("greywhale")
@dataclass(kw_only=True)
class GreywhaleConfig(RobotConfig):
    port: str | None = None  # of the board; None: the only board found
    joints: list[int] = field(default_factory=lambda: list(ALL))  # in use, as the board has them
    max_speed: float = 2.0  # rad/s, of a joint that actions lead
    cameras: dict[str, CameraConfig] = field(default_factory=dict)


@TeleoperatorConfig.register_subclass("greywhale_leader")
@dataclass(kw_only=True)
class GreywhaleLeaderConfig(TeleoperatorConfig):
    port: str | None = None
    joints: list[int] = field(default_factory=lambda: list(ALL))
