"""The pictures of an identification: nothing is cut off, and only joints in use have a panel."""

from __future__ import annotations

import numpy as np
import pytest
from matplotlib.figure import Figure

from greywhale.loop import multi_steps
from greywhale.pictures import identification as pictures
from greywhale.pictures import looks
from greywhale.pictures.identification import Trace
from greywhale.pictures.page import style
from tests.pictures.sight import faults


def responses(begun: str = "white box", joints: tuple[int, ...] = (0, 1, 2, 3)) -> Figure:
    time = np.arange(0.0, 16.0, 0.01)
    leader = multi_steps().at(time)
    said = ["MSE [rad²]: white box 0.000123,\nmodel 1.23e-05"] * 4
    recorded = Trace("recorded follower", time, 0.99 * leader, looks.FOLLOWER)
    simulated = [Trace(begun, time, 0.93 * leader, looks.WHITE_BOX), Trace("model", time, 0.991 * leader, looks.MODEL)]
    traces = [Trace("leader", time, leader, looks.LEADER), recorded, *simulated]
    title, error = "fit (another controller)", "recorded less simulated"
    return pictures.plot_responses(traces, recorded, title, error, joints=joints, said=said)


@pytest.mark.slow
@pytest.mark.parametrize("name", ["responses", "convergence"])
def test_nothing_is_cut_off_overlaps_or_lacks_a_unit(name: str) -> None:
    with style():
        costs = tuple(0.5 * 0.8**step for step in range(50))
        figure = responses() if name == "responses" else pictures.plot_convergence({"": costs}, "paper", looks.MODEL)
        assert faults(figure) == []


@pytest.mark.slow
@pytest.mark.parametrize("joints", [(2,), (0, 1, 3)])
def test_only_joints_in_use_have_a_panel(joints: tuple[int, ...]) -> None:
    with style():
        figure = responses(joints=joints)
        assert faults(figure) == []
        assert len(figure.axes) == 2 * len(joints)
