"""A log that is fitted neither validates nor is fitted again, whatever its name and its clock say."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from greywhale.arm import ArmParameters
from greywhale.base.errors import UserError
from greywhale.cli.entry import run
from greywhale.files.log import Log
from greywhale.identify import identify
from greywhale.identify.overlap import shares_samples
from tests.identify.conftest import rows
from tools.support.recordings import Recorded


def copy(log: Log, part: slice = slice(None), shift: float = 0.0, name: str = "copy.csv") -> Log:
    """A part of a log under another name, with another start of time."""
    cut = rows(log, part)
    return replace(cut, name=name, time=cut.time - shift)


@pytest.mark.parametrize(
    "part", [slice(None), slice(3000, 9000), slice(0, 4500), slice(5500, None)], ids=["all", "middle", "start", "end"]
)
def test_copy_and_cut_are_the_same_samples(recorded: Recorded, part: slice) -> None:
    cut = copy(recorded.fit, part, shift=1.234)
    assert shares_samples(recorded.fit, cut)
    assert shares_samples(cut, recorded.fit)


def test_cuts_that_overlap_are_the_same_samples_and_neighbours_are_not(recorded: Recorded) -> None:
    assert shares_samples(copy(recorded.fit, slice(0, 6000)), copy(recorded.fit, slice(4000, None)))
    assert not shares_samples(copy(recorded.fit, slice(0, 5000)), copy(recorded.fit, slice(5000, None)))


def test_rest_that_looks_the_same_does_not_count(recorded: Recorded) -> None:
    """Two recordings of a quiet bench begin with equal samples for seconds, before their motions differ."""
    one, other = (_after_rest(log, 6000) for log in (recorded.fit, recorded.second))
    assert not shares_samples(one, other)


def _after_rest(log: Log, count: int) -> Log:
    rest = np.zeros((count, 4))
    leader, follower, voltage = (np.vstack([rest, one[:4000]]) for one in (log.leader, log.follower, log.voltage))
    return replace(log, time=np.arange(count + 4000) / 1000, leader=leader, follower=follower, voltage=voltage)


def test_validation_on_a_fitted_log_is_refused_by_both_names(recorded: Recorded, white_box: ArmParameters) -> None:
    cut = copy(recorded.fit, slice(2000, 8000), shift=2.0, name="second.csv")
    with pytest.raises(UserError, match=r"fit\.csv and second\.csv .* not fitted") as refused:
        identify([recorded.fit], white_box, validate=[recorded.second, cut])
    assert refused.value.exit_code == 2


def test_log_is_fitted_once(recorded: Recorded, white_box: ArmParameters) -> None:
    with pytest.raises(UserError, match=r"fit\.csv and copy\.csv .* twice"):
        identify([recorded.fit, copy(recorded.fit)], white_box)


def test_verb_refuses_one_file_in_both_roles(recorded: Recorded, capsys: pytest.CaptureFixture[str]) -> None:
    assert run(["identify", recorded.fit.name, "-v", recorded.fit.name]) == 2
    assert f"{recorded.fit.name} is given twice; a model is validated on a log" in capsys.readouterr().err
    assert run(["identify", recorded.fit.name, recorded.fit.name]) == 2
    assert "is given twice; what is fitted twice counts twice" in capsys.readouterr().err
