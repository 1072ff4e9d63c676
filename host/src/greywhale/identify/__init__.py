"""Grey-box identification: from logs and the user's nominal arm to a model of the arm that made the logs.

>>> outcome = identify([read_log("log1.csv")], load_arm("arm.toml"), validate=[read_log("log2.csv")])
>>> outcome.save("model.toml")
"""

from greywhale.identify.found_model import ParameterEstimate
from greywhale.identify.result import IdentificationResult
from greywhale.identify.run import METHODS, identify, validated
from greywhale.identify.samples import loosen_gears, sampled_plants

__all__ = [
    "METHODS",
    "IdentificationResult",
    "ParameterEstimate",
    "identify",
    "loosen_gears",
    "sampled_plants",
    "validated",
]
