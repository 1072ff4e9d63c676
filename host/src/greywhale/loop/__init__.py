"""The closed loop of leader, firmware, motors and arm, for one candidate or thousands, far faster than real time.

>>> experiment = Experiment(human_reaches(), default_arm())
>>> result = experiment.run(controllers, plants)  # int32 (n, 4, 12) and float64 (n, 60): docs/closed_loop.md
>>> result.mse  # (n, 4), rad^2
"""

from greywhale.loop.experiment import Experiment, Result, Timing
from greywhale.loop.leader import leader_slices
from greywhale.loop.tables import CONTROLLER_COLUMNS, PLANT_COLUMNS, controller_row, default_controller, plant_row

__all__ = [
    "CONTROLLER_COLUMNS",
    "PLANT_COLUMNS",
    "Experiment",
    "Result",
    "Timing",
    "controller_row",
    "default_controller",
    "leader_slices",
    "plant_row",
]
