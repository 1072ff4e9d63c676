"""Commissioning: controllers that are proven on the arm itself, joint by joint, never worse than those from before.

>>> outcome = commission(CommissioningRequest(port, Path("commission"), load_arm("arm.toml")), report)
"""

from greywhale.commission.request import ROUNDS, TRIALS, CommissioningRequest
from greywhale.commission.result import CommissioningResult
from greywhale.commission.run import commission

__all__ = ["ROUNDS", "TRIALS", "CommissioningRequest", "CommissioningResult", "commission"]
