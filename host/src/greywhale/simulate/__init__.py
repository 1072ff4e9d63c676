"""The closed loop of leader, firmware, motors and arm, for one candidate or thousands, far faster than real time.

>>> experiment = Experiment(human_reaches(), default_arm())
>>> result = experiment.run(controllers, plants)  # int32 (n, 4, 13) and float64 (n, columns): docs/closed_loop.md
>>> result.mse  # (n, 4), rad^2
"""

from greywhale.arm.plants import PLANT_COLUMNS, plant_row
from greywhale.protocol.table import CONTROLLER_COLUMNS
from greywhale.simulate.closed_loop import Result, Timing
from greywhale.simulate.controllers import controller_row, controllers_of, default_controller
from greywhale.simulate.experiment import Experiment
from greywhale.simulate.leader import leader_slices

__all__ = [
    "CONTROLLER_COLUMNS",
    "PLANT_COLUMNS",
    "Experiment",
    "Result",
    "Timing",
    "controller_row",
    "controllers_of",
    "default_controller",
    "leader_slices",
    "plant_row",
]
