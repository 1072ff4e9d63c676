"""The paper's method: its 20 numbers, bounds and budget; that it is worse is a matter of the benchmarks."""

from __future__ import annotations

import numpy as np
import pytest

from greywhale.arm import ArmParameters
from greywhale.base.types import show_no_progress
from greywhale.files.arm import load_arm
from greywhale.identify import pack_search, paper
from greywhale.identify.closed_loop import Loop
from greywhale.identify.data import prepare
from greywhale.identify.run import identify
from greywhale.loop import plant_row
from greywhale.protocol.table import ParameterTable
from tools.support.recordings import Recorded


def test_table_4_gives_the_papers_arms(recorded: Recorded, white_box: ArmParameters) -> None:
    """The 20 values of either column of Table 4, through the search's own equations, are the shipped arms."""
    search = paper.PaperSearch(white_box, [], 0, show_no_progress)
    for name in ("white_box", "grey_box"):
        arm = load_arm(name)
        x = np.array([[getattr(joint.motor, value) for joint in arm.joint for value in paper.VALUES]])
        np.testing.assert_allclose(search.plants(x)[0], plant_row(arm), rtol=1e-12)


def test_with_the_white_box_in_its_pack_the_search_does_not_end_worse(
    recorded: Recorded, white_box: ArmParameters, monkeypatch: pytest.MonkeyPatch
) -> None:
    assert pack_search.BUDGET == 510, "the first pack and fifty moves"
    monkeypatch.setattr(pack_search, "BUDGET", 20)
    outcome = identify([recorded.fit], white_box, method="paper-started", seed=3)
    (fitted,) = outcome.verdicts
    assert outcome.found.simulations == 20
    assert outcome.complete
    assert sum(fitted.model) <= sum(fitted.white_box) * 1.001  # the judge's noise is its own


def test_the_search_on_logarithms_finds_friction_and_a_better_arm(
    recorded: Recorded, white_box: ArmParameters, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(pack_search, "BUDGET", 100)
    outcome = identify([recorded.fit], white_box, validate=[recorded.second], method="gwo-woa", seed=3)
    assert {one.name.split(".")[1] for one in outcome.estimates} == {"alpha", "inertia", "damping", "coulomb"}
    for one in outcome.estimates:
        assert one.white_box / 12.2 <= one.value <= 12.2 * one.white_box  # e^2.5
    assert outcome.verdicts[1].improvement > 0.3


def test_search_stays_within_table_2_and_never_gets_worse(
    recorded: Recorded, white_box: ArmParameters, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(pack_search, "BUDGET", 60)
    outcome = identify([recorded.fit], white_box, validate=[recorded.second], method="paper", seed=3)
    values = np.array([one.value for one in outcome.estimates]).reshape(4, 5)
    assert np.all(values >= paper.LOWER)
    assert np.all(values <= paper.UPPER)
    assert outcome.found.simulations == 60
    assert len(outcome.found.curve) == 6
    assert np.all(np.diff(outcome.found.curve) <= 0.0)
    assert outcome.found.curve[-1] == pytest.approx(sum(outcome.verdicts[0].model), rel=1e-6)
    assert "joint 3" in outcome.text()
    assert "all joints" in outcome.text()


def test_cost_is_equation_5(recorded: Recorded, white_box: ArmParameters) -> None:
    """The sum over the joints of the mean squared difference of model and recorded follower."""
    loop = Loop(prepare(recorded.fit, 1), ParameterTable.defaults(), white_box)
    plant = plant_row(white_box)[None]
    difference = loop.angles(plant)[0] - loop.follower[::5]
    assert loop.error(plant).sum() == pytest.approx(np.mean(difference**2, axis=0).sum())
    assert loop.error(plant).sum() > 1e-4
