"""Grey-box identification: from logs and the user's nominal arm to a model of the arm that made the logs.

>>> outcome = identify([read_log("log1.csv")], load_arm("arm.toml"), validate=[read_log("log2.csv")])
>>> outcome.save("model.toml")
"""

from greywhale.identify.found import ParameterEstimate
from greywhale.identify.identification import METHODS, identify
from greywhale.identify.outcome import Outcome
from greywhale.identify.samples import sampled_plants

__all__ = ["METHODS", "Outcome", "ParameterEstimate", "identify", "sampled_plants"]
