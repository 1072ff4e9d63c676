"""Adaptation: the controllers stay right while a person works with the arm. The paper's wish: online tuning by GWO-WOA.

>>> outcome = adapt(AdaptationRequest(port, Path("model.toml"), Path("adapted.toml"), LocalWorkers(1)))
"""

from greywhale.adapt.result import AdaptationResult
from greywhale.adapt.run import BUDGET, SECONDS, AdaptationRequest, adapt, store_kept

__all__ = ["BUDGET", "SECONDS", "AdaptationRequest", "AdaptationResult", "adapt", "store_kept"]
