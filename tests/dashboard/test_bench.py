"""A page's wishes to the simulated bench: each does what it says, and what is none changes nothing."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import numpy as np
import pytest

from greywhale._native import Person
from greywhale.base.errors import UserError
from greywhale.dashboard.answers import Answers
from greywhale.dashboard.bench import BenchControls
from greywhale.dashboard.folder import Folder
from greywhale.files.leader import save_leader
from greywhale.files.trajectory import Trajectory
from greywhale_sim.lockstep import LockStepBench
from tests.dashboard.shared import Shared, jobs_of


@pytest.fixture
def controls(bench: LockStepBench, tmp_path: Path) -> BenchControls:
    return BenchControls(bench, Folder(tmp_path))


def test_a_page_leads_by_hand(bench: LockStepBench, controls: BenchControls) -> None:
    low, high = (np.array(controls.controls()["leader"][end]) for end in ("minimum", "maximum"))
    pose = [0.5, 1, -0.5, 0.25]
    assert ((low < pose) & (pose < high)).all()
    assert controls.change({"leader": pose}) == {}
    bench.bench.run(1.0)
    assert bench.bench.leader.angles == pytest.approx(pose, abs=1e-3)
    controls.change({"motion": "hold"})
    bench.bench.run(0.5)
    assert bench.bench.leader.angles == pytest.approx(pose, abs=1e-3)


def test_a_recorded_motion_is_taken_up(bench: LockStepBench, controls: BenchControls, tmp_path: Path) -> None:
    save_leader(tmp_path / "it's mine.csv", Trajectory(np.array([0.0, 1.0]), np.array([[0.3] * 4, [0.5] * 4])))
    controls.change({"motion": "it's mine.csv"})
    bench.bench.run(2.0)
    assert bench.bench.leader.angles == pytest.approx([0.3] * 4)
    controls.change({"motion": "reaches"})
    bench.bench.run(2.0)
    assert bench.bench.leader.angles == pytest.approx(bench.bench.leader.home)
    with pytest.raises(UserError, match="it is not in"):
        controls.change({"motion": "../motion.csv"})


@pytest.mark.parametrize(
    ("wish", "key", "value"),
    [
        ({"supply": 9}, "supply", 9.0),
        ({"speed": 0.25}, "speed", 0.25),
        ({"load": 0.2}, "load", 0.2),
        ({"power": False}, "power", False),
        ({"power": True}, "power", True),
    ],
)
def test_a_wish_is_told_in_what_there_is_then(
    controls: BenchControls, wish: dict[str, Any], key: str, value: float
) -> None:
    told = controls.change(wish)[key]
    assert (told["value"] if isinstance(told, dict) else told) == value


def test_every_fault_is_staged_by_its_name_and_mended(bench: LockStepBench, controls: BenchControls) -> None:
    found = controls.controls()["faults"]
    assert len({fault["name"] for fault in found}) == len(found) > 10
    for fault in found:
        controls.change({"fault": ":".join([fault["name"], *fault["places"][:1]])})
    assert bench.bench.has_pot_faults
    controls.change({"fault": None})
    assert not bench.bench.has_pot_faults
    assert bench.bench.motor_gains == [1.0] * 4
    controls.change({"estop": True})
    assert bench.bench.estop_pressed
    controls.change({"estop": False})
    controls.change({"clutch": True})
    assert bench.bench.clutch_pressed


def test_hands_do_what_a_calibration_asks_and_say_how_long_it_takes(
    bench: LockStepBench, controls: BenchControls
) -> None:
    person = bench.bench.leader
    for wish in ({"turn": 5}, {"pose": [0.1, 0.2, 0.3, 0.4]}, {"hang": True}):
        takes_s = controls.change(wish)["takes_s"]
        assert takes_s > 0.5
        assert person.on_the_way
        bench.bench.run(takes_s - 0.01)
        assert person.on_the_way
        bench.bench.run(0.02)
        assert not person.on_the_way
    leader, follower = person.rest
    assert leader == pytest.approx([0.1, 0.2, 0.3, 0.4])
    assert follower == pytest.approx(Person.HANGING)
    controls.change({"pose": [0, 0, 0, 0]})
    bench.bench.run(1.1)


@pytest.mark.parametrize(
    "wish",
    [
        *({"turn": 8}, {"turn": -1}, {"turn": "0; power off"}, {"pose": [0, 0, 0]}, {"pose": [0, 0, 0, 7]}),
        *({"pose": [0, 0, 0, "0; power off"]}, {"hang": False}),
        *({}, {"dance": 1}, {"leader": [1, 2, 3]}, {"leader": [1, 2, 3, "4; power off"]}, {"leader": [0, 0, 0, 1e9]}),
        *(
            {"supply": True},
            {"supply": "9"},
            {"supply": float("nan")},
            {"supply": 10**400},
            {"fault": "dance"},
            {"fault": "x\npower off"},
        ),
        *({"power": 1}, {"motion": ""}, {"motion": "x" * 5000}, {"speed": 0}, {"leader": [0, 0, 0, -(10**400)]}),
    ],
)
def test_what_is_no_wish_changes_nothing(bench: LockStepBench, controls: BenchControls, wish: dict[str, Any]) -> None:
    before = controls.controls()
    with pytest.raises(UserError):
        controls.change(wish)
    assert controls.controls() == before


def test_while_a_page_drives_no_other_changes_the_bench(
    shared: Shared, bench: LockStepBench, controls: BenchControls, tmp_path: Path
) -> None:
    folder = Folder(tmp_path)
    answers = Answers(shared.relay, folder, "default", jobs_of(shared.relay, folder), controls)
    driver, watcher = shared.page().client, shared.page().client
    answers.change_bench({"load": 0.1}, watcher.id)  # nobody drives yet
    shared.relay.drive(driver)
    before = controls.controls()
    wishes: list[dict[str, Any]] = [
        *({"fault": "pot-open:follower1"}, {"fault": None}, {"leader": [0.5] * 4}, {"motion": "hold"}),
        *({"power": False}, {"estop": False}, {"clutch": True}, {"supply": 9}, {"load": 0.2}, {"speed": 0.5}),
    ]
    for wish in wishes:
        for page in (watcher.id, "", "no page"):
            with pytest.raises(UserError, match="another page drives this arm"):
                answers.change_bench(dict(wish), page)
    assert controls.controls() == before
    assert answers.change_bench({"load": 0.2}, driver.id)["load"]["value"] == 0.2
    shared.relay.release(driver)
    assert answers.change_bench({"load": 0}, watcher.id)["load"]["value"] == 0
