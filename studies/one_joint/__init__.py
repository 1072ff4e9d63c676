"""Identification of a single joint of any rig: other controllers than greywhale's, torques, gravity, delays.

>>> model = identify_joint(rig, [Example(record, law)])
>>> Runner(other, other_law).run(model.plant, pieces_of(other, 0, len(other.time))).angles
"""

from studies.one_joint.fit import Example, JointModel, fit_joint, identify_joint
from studies.one_joint.law import (
    Law,
    proportional,
    proportional_derivative,
    proportional_resonant,
    relay,
    trapezoidal_pid,
)
from studies.one_joint.loop import Run, Runner
from studies.one_joint.naive import Lag, fit_lag
from studies.one_joint.plant import COLUMNS, JointSpace, Rig, plants
from studies.one_joint.record import Pieces, Record, pieces_of

__all__ = [
    "COLUMNS",
    "Example",
    "JointModel",
    "JointSpace",
    "Lag",
    "Law",
    "Pieces",
    "Record",
    "Rig",
    "Run",
    "Runner",
    "fit_joint",
    "fit_lag",
    "identify_joint",
    "pieces_of",
    "plants",
    "proportional",
    "proportional_derivative",
    "proportional_resonant",
    "relay",
    "trapezoidal_pid",
]
