"""A joint that knocks about in its gap gets its gear from short windows."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

from greywhale.arm import ArmParameters
from greywhale.arm.plants import column
from greywhale.base.types import show_no_progress
from greywhale.files.arm import default_arm
from greywhale.identify.candidate import Candidate
from greywhale.identify.data import Prepared, prepare
from greywhale.identify.knocking import knocking_joints, knocking_starts, turns_of, with_better_gears
from greywhale.identify.search import Search
from greywhale.identify.space import KINDS, MOTOR, Space
from greywhale.identify.uncertainty import uncertainty
from greywhale.identify.windows import WindowResidual
from greywhale.loop import human_reaches
from greywhale.protocol.table import ParameterTable
from tools.support.recordings import record

ROLL = 3


@pytest.fixture(scope="module")
def knocker() -> ArmParameters:
    """The default arm with a roll whose light link moves freely in a wide gap."""
    data = default_arm().model_dump()
    data["joint"][ROLL]["gear"] = {"half_gap": 4.5e-3, "stiffness": 12.7, "damping": 0.0085}
    return ArmParameters.model_validate(data, strict=False)


@pytest.fixture(scope="module")
def log(knocker: ArmParameters, tmp_path_factory: pytest.TempPathFactory) -> Prepared:
    folder: Path = tmp_path_factory.mktemp("knocks")
    made = record(knocker, human_reaches(1, 10.0), folder / "knocks.csv", seed=3)
    return prepare(made, ParameterTable.defaults()["filter_shift"])


@pytest.fixture
def windows(log: Prepared, knocker: ArmParameters) -> WindowResidual:
    return WindowResidual([log], knocker, range(4))


@pytest.fixture
def true_model(knocker: ArmParameters) -> Candidate:
    """The arm with teeth that ring as a search takes for granted."""
    space = Space.of(knocker, (*MOTOR, "gap", "teeth", "ringing"), range(4))
    usual = {"ringing": KINDS["ringing"].start}
    return Candidate(space, space.start(), "backlash").with_values(usual)


@pytest.mark.slow
def test_short_windows_tell_its_gear(windows: WindowResidual, true_model: Candidate) -> None:
    """Over the usual ones chance decides where it is, and stiff teeth with less gap err less than what is true."""
    bend = true_model.plant[column("torque_per_volt", ROLL)] * true_model.plant[column("supply")] / 300.0
    numbers, x = true_model.space.names, true_model.x.copy()
    x[numbers.index("joint3.gap")], x[numbers.index("joint3.teeth")] = 3e-3, np.log(bend)
    stiff = replace(true_model, x=x)

    def error(of: WindowResidual, model: Candidate) -> float:
        return float(of.settled_error(model.plant, model.zero)[ROLL])

    assert error(windows, true_model) > 1.02 * error(windows, stiff)
    assert error(windows.brief, true_model) < 0.97 * error(windows.brief, stiff)
    found = with_better_gears(stiff, replace(true_model, knocking=(ROLL,)), windows)
    np.testing.assert_array_equal(found.x, true_model.x)
    assert found.knocking == (ROLL,)
    same = with_better_gears(true_model, replace(stiff, knocking=(ROLL,)), windows)
    np.testing.assert_array_equal(same.x, true_model.x)
    assert same.knocking == ()


def test_it_is_the_joint_that_the_usual_windows_miss(windows: WindowResidual, true_model: Candidate) -> None:
    assert knocking_joints(windows, true_model) == (ROLL,)
    windows.limits = replace(windows.limits, search=replace(windows.limits.search, knocking=0.0))
    assert knocking_joints(windows, true_model) == (0, 1, 2, 3)


def test_other_joints_begin_where_they_were(true_model: Candidate, log: Prepared) -> None:
    starts = knocking_starts(true_model, (ROLL,), [true_model.with_values({"gap": 1e-3, "teeth": 1e-3})], [log])
    mine = np.array([one.joint == ROLL for one in true_model.space.parameters])
    gap = true_model.space.names.index(f"joint{ROLL}.gap")
    assert len({one.x[gap] for one in starts}) == len(starts) == 4
    for one in starts:
        np.testing.assert_array_equal(one.x[~mine], true_model.x[~mine])
        assert one.knocking == (ROLL,)


def test_only_its_gear_is_fitted_to_short_windows(windows: WindowResidual, true_model: Candidate) -> None:
    space = true_model.space
    (brief, short), (usual, rest) = turns_of(windows, space, (ROLL,))
    assert (brief, usual) == (windows.brief, windows)
    assert [name for name, one in zip(space.names, short, strict=True) if one] == [
        f"joint{ROLL}.{kind}" for kind in ("gap", "teeth", "ringing")
    ]
    np.testing.assert_array_equal(rest, ~short)
    ((usual, rest),) = turns_of(windows, space, ())
    assert usual is windows
    assert rest.all()


@pytest.mark.slow
def test_a_search_finds_that_joint(log: Prepared) -> None:
    """From an arm file with stiff teeth and less gap, at which the usual windows stay."""
    arm = default_arm()
    space = Space.of(arm, (*MOTOR, "coulomb", "gap", "drag", "teeth"), range(4))
    search = Search(arm, [log], (), range(4), 0, show_no_progress, begin=Candidate(space, space.start(), "backlash"))
    search.run()
    assert search.best is not None
    assert search.best.knocking == (ROLL,)
    assert search.best.plant[column("half_gap", ROLL)] > 4e-3


def test_its_gear_is_as_certain_as_short_windows_say(windows: WindowResidual, knocker: ArmParameters) -> None:
    space = Space.of(knocker, ("gap", "drag"), (ROLL,))
    found, short, usual = (
        uncertainty(of, space, space.start(), (ROLL,), joints).covariance
        for of, joints in ((windows, (ROLL,)), (windows.brief, ()), (windows, ()))
    )
    np.testing.assert_allclose(found, short, rtol=1e-9)
    assert not np.allclose(found, usual, rtol=0.01)
