"""Errors are differences of readings, as the board and a log see them: zero angles, play and lag are in them."""

from __future__ import annotations

import numpy as np
import pytest

from greywhale.arm import ArmParameters
from greywhale.arm.parameters import with_usual_noise
from greywhale.arm.plants import column, plant_row
from greywhale.files.arm import default_arm
from greywhale.loop import Experiment, human_reaches
from greywhale.loop.closed_loop import FollowerLines, shown_angles
from greywhale.loop.led_model import predict
from greywhale.loop.traces import Traces
from greywhale.protocol.firmware import TICK_S
from greywhale.protocol.table import ParameterTable
from greywhale.tune.search.training import reach
from tests.support.arms import make_arm

ZERO_RAD = 0.25
YAW = 0  # feels no gravity, so its zero angle changes nothing that a board sees


def turned(joint: int) -> ArmParameters:
    """The default arm with a follower's potentiometer that stands at 0 where the joint is at `ZERO_RAD`."""
    arm = default_arm()
    pots = [
        pot.model_copy(update={"centre": ZERO_RAD * (at == joint)}) for at, pot in enumerate(arm.follower_pots.joint)
    ]
    return arm.model_copy(update={"follower_pots": arm.follower_pots.model_copy(update={"joint": tuple(pots)})})


def test_a_zero_angle_that_changes_no_reading_changes_no_error() -> None:
    motion = human_reaches(4, 3.0)
    sound, off = (Experiment(motion, arm, noise=False) for arm in (default_arm(), turned(YAW)))
    assert off.home[YAW] - sound.home[YAW] == pytest.approx(ZERO_RAD)
    np.testing.assert_array_equal(off.home[1:], sound.home[1:])
    for result, usual in ((off.run(), sound.run()), (off.run_exact(), sound.run_exact())):
        np.testing.assert_allclose(result.mse[0], usual.mse[0], rtol=0.02)
        np.testing.assert_allclose(result.itae[0], usual.itae[0], rtol=0.02)


def test_a_board_that_knows_the_zero_angle_reads_the_true_one() -> None:
    pot = default_arm().follower_pots.joint[YAW]
    table = ParameterTable.defaults()
    counts = round(ZERO_RAD / pot.track * 16384)
    known = table.with_raw({"follower0.zero": table["follower0.zero"] - counts})
    assert FollowerLines.of(turned(YAW), known).plus == pytest.approx(np.zeros(4), abs=1e-3)


@pytest.mark.parametrize("direction", [1, -1])
def test_a_led_model_reads_a_potentiometer_as_its_board_does(direction: int) -> None:
    """One that is mounted turned or the other way round, and calibrated so, changes nothing."""
    arm, table = with_usual_noise(default_arm()), ParameterTable.defaults()
    time_s = np.arange(300) * TICK_S
    path = np.repeat(0.3 * np.sin(6.0 * time_s)[:, None], 4, axis=1)
    played = Traces(leader=path, follower=path, voltage=np.zeros_like(path), begins=0.0)
    pots = [pot.model_copy(update={"centre": ZERO_RAD, "direction": direction}) for pot in arm.follower_pots.joint]
    turned_arm = arm.model_copy(update={"follower_pots": arm.follower_pots.model_copy(update={"joint": tuple(pots)})})
    counts = round(direction * ZERO_RAD / pots[0].track * 16384)
    raw = {f"follower{joint}.zero": 8184 - counts for joint in range(4)}
    raw |= {f"follower{joint}.scale": direction * table[f"follower{joint}.scale"] for joint in range(4)}
    (usual,), (turned_one,) = predict(arm, table, played), predict(turned_arm, table.with_raw(raw), played)
    np.testing.assert_allclose(turned_one.follower, usual.follower, atol=2e-3)


def test_play_and_lag_count_as_they_are_shown() -> None:
    plant = plant_row(default_arm())
    plant[column("pot_play", 1)], plant[column("pot_lag", 2)] = 0.02, 0.005
    experiment = Experiment(human_reaches(4, 3.0), default_arm(), noise=False)
    for result in (experiment.run(None, plant, every=1), experiment.run_exact(None, plant, every=1)):
        shown = shown_angles(result.angles, plant[None], TICK_S)[0]
        wanted = np.mean((experiment.leader - shown) ** 2, axis=0)
        np.testing.assert_allclose(result.mse[0], wanted, rtol=0.01)
        true = np.mean((experiment.leader - result.angles[0]) ** 2, axis=0)
        assert true[1] < 0.8 * wanted[1]


def test_stops_are_where_a_leader_would_take_the_follower_into_them() -> None:
    arm, table = make_arm(every_joint={"stops": {"min": -1.0, "max": 1.0}}), ParameterTable.defaults()
    off = turned(YAW).model_copy(update={"joint": arm.joint})
    (low, high), (off_low, off_high) = (reach(one, table, plant_row(one)[None]) for one in (arm, off))
    np.testing.assert_allclose(low - off_low, [ZERO_RAD, 0.0, 0.0, 0.0], atol=1e-9)
    np.testing.assert_allclose(high - off_high, [ZERO_RAD, 0.0, 0.0, 0.0], atol=1e-9)
