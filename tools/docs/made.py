"""Texts of pages that the code knows: each has its place where a page holds the comment."""

from __future__ import annotations

from collections.abc import Callable
from functools import partial

from greywhale.adapt.limits import ADAPTATION_LIMITS
from greywhale.arm import limits as arm
from greywhale.base.limits import markdown_list, markdown_list_of
from greywhale.board import limits as board
from greywhale.commission.limits import COMMISSIONING_LIMITS
from greywhale.dashboard import limits as dashboard
from greywhale.files.log import limits as logs
from greywhale.identify.limits import IDENTIFICATION_LIMITS
from greywhale.measure.limits import EVALUATION_LIMITS, REPEATABILITY_LIMITS, SWING_LIMITS
from greywhale.observe.limits import TORQUE_LIMITS
from greywhale.tune.limits import TUNING_LIMITS
from greywhale_sim import commands

MADE: dict[str, Callable[[], str]] = {
    "<!-- commands -->": commands.markdown_list,
    "<!-- limits: identification -->": partial(markdown_list, IDENTIFICATION_LIMITS),
    "<!-- limits: tuning -->": partial(markdown_list, TUNING_LIMITS),
    "<!-- limits: commissioning -->": partial(markdown_list, COMMISSIONING_LIMITS),
    "<!-- limits: adaptation -->": partial(markdown_list, ADAPTATION_LIMITS),
    "<!-- limits: swings -->": partial(markdown_list, SWING_LIMITS),
    "<!-- limits: evaluation -->": partial(markdown_list, EVALUATION_LIMITS),
    "<!-- limits: logs -->": partial(markdown_list_of, logs),
    "<!-- limits: arms -->": partial(markdown_list_of, arm),
    "<!-- limits: boards -->": partial(markdown_list_of, board),
    "<!-- limits: dashboard -->": partial(markdown_list_of, dashboard),
    "<!-- limits: repeatability -->": partial(markdown_list, REPEATABILITY_LIMITS),
    "<!-- limits: outside torques -->": partial(markdown_list, TORQUE_LIMITS),
}
