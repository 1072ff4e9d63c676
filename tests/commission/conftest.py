"""A commissioning on a simulated rig, with a model that fits it, so that nothing has to be identified."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from pathlib import Path

import pytest

from greywhale.commission import CommissioningRequest
from greywhale.commission.journal import CommissioningJournal
from greywhale.commission.motions import check_motion
from greywhale.commission.trials import Trials
from greywhale.files.arm import default_arm
from tests.commission.simulated import options_in
from tools.support.simulated_rig import ROOM, SimulatedRig


@pytest.fixture
def rig() -> SimulatedRig:
    """The default arm."""
    return SimulatedRig(default_arm())


@pytest.fixture
def trials(tmp_path: Path, rig: SimulatedRig) -> Iterator[Trials]:
    """Nothing tried yet."""
    with CommissioningJournal(tmp_path / "trials", {}, resume=False) as journal:
        yield Trials(journal, check_motion(ROOM), rig.before)


@pytest.fixture
def options(tmp_path: Path) -> Callable[..., CommissioningRequest]:
    """A short commissioning that begins with a model of the default arm."""
    return options_in(tmp_path)
