"""The pictures of an identification: nothing is cut off, and only joints in use have a panel."""

from __future__ import annotations

import numpy as np
import pytest
from matplotlib.figure import Figure

from greywhale.motion import multi_steps
from greywhale.pictures import identification as pictures
from greywhale.pictures.page import style
from tests.pictures.sight import faults


def responses(begun: str = "white box", joints: tuple[int, ...] = (0, 1, 2, 3)) -> Figure:
    time = np.arange(0.0, 16.0, 0.01)
    leader = multi_steps().at(time)
    simulated = {begun: 0.93 * leader, "model": 0.991 * leader}
    said = ["MSE [rad²]: white box 0.000123,\nmodel 1.23e-05"] * 4
    return pictures.plot_responses(time, leader, 0.99 * leader, simulated, said, "fit (another controller)", joints)


@pytest.mark.slow
@pytest.mark.parametrize("name", ["responses", "convergence"])
def test_nothing_is_cut_off_overlaps_or_lacks_a_unit(name: str) -> None:
    with style():
        costs = tuple(0.5 * 0.8**step for step in range(50))
        figure = responses() if name == "responses" else pictures.plot_convergence(costs, "paper-printed")
        assert faults(figure) == []


@pytest.mark.slow
@pytest.mark.parametrize("joints", [(0, 1), (2,), (0, 1, 3)])
def test_only_joints_in_use_have_a_panel(joints: tuple[int, ...]) -> None:
    with style():
        figure = responses(joints=joints)
        assert faults(figure) == []
        assert len(figure.axes) == 2 * len(joints)
