"""The follower arm and its sensors, from a TOML file to a thing that moves.

>>> arm = Arm(default_arm())
>>> angles = arm.step([3.0, 0.0, 0.0, 0.0], 0.001)
"""

from greywhale._native import PotFault, PotFaults, Wiring
from greywhale.arm.parameters import ArmParameters, PotentiometerBank
from greywhale.arm.plant import Arm, Potentiometers
from greywhale.arm.printed import ERRATA, PrintedBody

__all__ = [
    "ERRATA",
    "Arm",
    "ArmParameters",
    "PotFault",
    "PotFaults",
    "PotentiometerBank",
    "Potentiometers",
    "PrintedBody",
    "Wiring",
]
