"""Excitation: the motion from whose log an arm can be identified best, within its limits.

>>> made = design(load_arm("arm.toml"), pose=[0.0, 0.4, 0.0, 0.0], seconds=20.0)
>>> save_leader("motion.csv", made.motion)
"""

from greywhale.identify.excite.design import BUDGET, SECONDS, Design, Problem, check_effort, design
from greywhale.identify.excite.limits import parse_range, room_of

__all__ = ["BUDGET", "SECONDS", "Design", "Problem", "check_effort", "design", "parse_range", "room_of"]
