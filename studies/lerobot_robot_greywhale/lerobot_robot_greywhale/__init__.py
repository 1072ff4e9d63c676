"""A greywhale arm as LeRobot's robot `greywhale` and teleoperator `greywhale_leader`."""

from lerobot_robot_greywhale.config import GreywhaleConfig, GreywhaleLeaderConfig
from lerobot_robot_greywhale.leader import GreywhaleLeader
from lerobot_robot_greywhale.robot import Greywhale

__all__ = ["Greywhale", "GreywhaleConfig", "GreywhaleLeader", "GreywhaleLeaderConfig"]
