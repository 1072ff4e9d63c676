"""The closed loop of leader, firmware, motors and arm, for one candidate or thousands, far faster than real time.

>>> experiment = Experiment(human_reaches(), default_arm())
>>> result = experiment.run(controllers, plants)  # int32 (n, 4, 13) and float64 (n, columns): docs/closed_loop.md
>>> result.mse  # (n, 4), rad^2
"""

from greywhale.arm.plants import PLANT_COLUMNS, plant_row
from greywhale.loop.closed_loop import Result, Timing
from greywhale.loop.controllers import controller_row, controllers_of, default_controller
from greywhale.loop.experiment import Experiment
from greywhale.loop.leader import leader_slices
from greywhale.loop.leader_motions import human_reaches, multi_steps, steps
from greywhale.protocol.table import CONTROLLER_COLUMNS

__all__ = [
    "CONTROLLER_COLUMNS",
    "PLANT_COLUMNS",
    "Experiment",
    "Result",
    "Timing",
    "controller_row",
    "controllers_of",
    "default_controller",
    "human_reaches",
    "leader_slices",
    "multi_steps",
    "plant_row",
    "steps",
]
