"""A commissioning that ends early says how to go on, where the same command would, and only there."""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path

import pytest

from greywhale.base.errors import BadUsage, UserError
from greywhale.board.stream import LeaseLostError
from greywhale.commission import CommissioningRequest, commission
from greywhale.commission.journal import AnewError
from greywhale.protocol.transport import PortDisturbedError, PortLostError
from tests.commission.simulated import in_no_time
from tools.support.simulated_rig import SimulatedRig

GOES_ON = "The same command with --resume goes on in the folder {}."


@pytest.fixture(autouse=True)
def _in_no_time(rig: SimulatedRig, monkeypatch: pytest.MonkeyPatch) -> None:
    in_no_time(rig, monkeypatch)


def ended_by(ending: BaseException, rig: SimulatedRig, request: CommissioningRequest) -> list[str]:
    """The notes of what ended it, in the middle of the first motion."""

    def end(number: int) -> None:
        raise ending

    rig.at_play = end
    with pytest.raises(type(ending)) as caught:
        commission(request)
    return getattr(caught.value, "__notes__", [])


@pytest.mark.parametrize(
    "ending",
    [
        LeaseLostError("port", 1000),
        PortLostError("port"),
        PortDisturbedError("port", "reads from the port too"),
        UserError("the board stopped the motors: a wire is broken"),
    ],
    ids=lambda ending: type(ending).__name__,
)
def test_every_ending_of_which_the_cause_can_be_mended_names_resume(
    ending: UserError, rig: SimulatedRig, options: Callable[..., CommissioningRequest], tmp_path: Path
) -> None:
    assert ended_by(ending, rig, options()) == [GOES_ON.format(tmp_path / "out")]


def test_ctrl_c_also_says_what_the_board_runs(
    rig: SimulatedRig, options: Callable[..., CommissioningRequest], tmp_path: Path
) -> None:
    notes = ended_by(KeyboardInterrupt(), rig, options())
    assert notes == ["The board keeps the controllers from before. " + GOES_ON.format(tmp_path / "out")]


@pytest.mark.parametrize(
    "ending",
    [
        AnewError("the arm cannot be excited: joint 1 hunted; narrow the --range."),
        BadUsage("--range names joint 3, which is not in use; leave it out."),
        UserError("out/commission.journal: cannot be written: no space; make room and go on with --resume."),
    ],
    ids=["other options", "bad usage", "said already"],
)
def test_what_the_same_command_would_meet_again_does_not(
    ending: UserError, rig: SimulatedRig, options: Callable[..., CommissioningRequest]
) -> None:
    assert ended_by(ending, rig, options()) == []
