"""Drives the arm at a port with lerobot's own discovery and factory, no teleoperator; then dies with the motors on."""

import json
import os
import signal
import sys
import time

from lerobot.robots import RobotConfig, make_robot_from_config
from lerobot.teleoperators import TeleoperatorConfig, make_teleoperator_from_config
from lerobot.utils.import_utils import register_third_party_plugins

register_third_party_plugins()
port = sys.argv[1]
config = RobotConfig.get_choice_class("greywhale")(port=port, id="test", max_speed=1.0)
robot = make_robot_from_config(config)
teleop = make_teleoperator_from_config(TeleoperatorConfig.get_choice_class("greywhale_leader")(port=port, id="test"))
said = []


def refused(call, *arguments):
    try:
        call(*arguments)
    except Exception as error:
        said.append(str(error))


def step(action):
    sent = robot.send_action(action)
    time.sleep(1 / 30)
    return sent, robot.get_observation()


robot.connect()
refused(teleop.connect)
start = robot.get_observation()
goal = {name: start[name] + 0.6 for name in robot.action_features}
begin = time.monotonic()
path = [(time.monotonic() - begin, step(goal)[1]["yaw.pos"]) for _ in range(45)]
sent, _ = step({**goal, "yaw.pos": 9.0})
refused(robot.send_action, {**goal, "yaw.pos": float("nan")})
refused(robot.send_action, {"yaw.pos": 0.0})
robot.disconnect()
teleop.connect()  # the board is free again
robot.connect()
for _ in range(15):
    followed, observed = step(teleop.get_action())
refused(robot.send_action, goal)
facts = {"said": said, "start": start, "goal": goal, "path": path, "sent": sent}
print(json.dumps({**facts, "followed": followed, "observed": observed}), flush=True)
os.kill(os.getpid(), signal.SIGKILL)
