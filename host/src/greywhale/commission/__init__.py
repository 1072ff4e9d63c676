"""Commissioning: controllers that are proven on the arm itself, joint by joint, never worse than those from before.

>>> outcome = commission(Options(port, Path("commission"), load_arm("arm.toml")), report)
"""

from greywhale.commission.campaign import ROUNDS, TRIALS, Options, commission
from greywhale.commission.outcome import Outcome

__all__ = ["ROUNDS", "TRIALS", "Options", "Outcome", "commission"]
