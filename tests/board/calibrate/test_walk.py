"""The person's way through sweeps and poses: on, back, again, later, and as many mistakes as it takes."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from typing import Any

import numpy as np
import pytest

from greywhale.arm.parameters import JOINT_NAMES
from greywhale.base.errors import UserError
from greywhale.board.calibrate.person import PersonAnswer, Watch
from greywhale.board.calibrate.walk import Walk
from greywhale.board.calibrate.words import POSITIVE_WAYS, poses_asked
from greywhale.board.limits import CALIBRATION
from greywhale.board.pots import FULL_SCALE
from greywhale.protocol import schema
from greywhale.protocol.joints import ALL, Joints
from greywhale.protocol.table import ParameterTable

TABLE = ParameterTable.defaults()
TRACK_RAD = float(np.radians(300.0))
COUNTS_PER_RAD = FULL_SCALE / TRACK_RAD
SWEEP = COUNTS_PER_RAD * np.interp(np.arange(400), [0, 100, 200, 400], [0.0, 1.0, -1.0, 0.0])
DONE, BACK, AGAIN, SKIP = PersonAnswer.DONE, PersonAnswer.BACK, PersonAnswer.AGAIN, PersonAnswer.SKIP
Step = tuple[str, Callable[["Arms"], None], PersonAnswer]


class Arms:
    """Stands for a board: eight potentiometers at rest, or turned as `turn` and `hold` say."""

    port, lease_ms = "port", 0

    def __init__(self) -> None:
        self.at = np.full(8, 500.0)
        self.coming: list[np.ndarray] = []
        self.drift = 0.0  # counts a millisecond
        self._tick = 0

    def telemetry(self, every: int) -> None:
        pass

    def clock(self) -> float:
        return self._tick / 1000

    def turn(self, *pots: int) -> None:
        for row in SWEEP:
            self.coming.append(self.at + row * np.isin(np.arange(8), pots))

    def hold(self, rad: float, apart: float) -> None:
        self.at = np.full(8, 500.0) + COUNTS_PER_RAD * np.repeat([rad, rad + apart], 4)

    def samples(self) -> list[schema.Sample]:
        rows, self.coming = (self.coming or [self.at + self.drift * ms for ms in range(CALIBRATION.held_ticks)]), []
        return [self._sample(row) for row in rows]

    def _sample(self, counts: np.ndarray) -> schema.Sample:
        self._tick += 1
        names = [f"{side}{joint}" for side in ("leader", "follower") for joint in range(4)]
        raw = [
            round((16.0 * count - TABLE[f"{name}.zero"]) * TABLE[f"{name}.scale"] / 2**13)
            for name, count in zip(names, counts, strict=True)
        ]
        return schema.Sample(
            tick=self._tick,
            leader=(raw[0], raw[1], raw[2], raw[3]),
            follower=(raw[4], raw[5], raw[6], raw[7]),
            voltage=(0, 0, 0, 0),
            state=schema.State.DISABLED,
            fault=schema.Fault.NONE,
        )


class Script:
    """A person who does one step after another; each says how the prompt must begin."""

    def __init__(self, arms: Arms, steps: Sequence[Step], patient: bool = True) -> None:
        self.patient = patient
        self.asked: list[str] = []
        self.told: list[str] = []
        self.shown: list[str] = []
        self.left = list(steps)
        self._arms = arms
        self._answer = DONE

    def ask(self, what: str) -> None:
        self.asked.append(what)
        begins, do, self._answer = self.left.pop(0)
        assert what.startswith(begins), what
        do(self._arms)

    def show(self, live: str) -> None:
        self.shown.append(live)

    def answer(self) -> PersonAnswer | None:
        return None if self._arms.coming else self._answer

    def tell(self, what: str) -> None:
        self.told.append(what)


def rest(arms: Arms) -> None:
    """Do nothing."""


def turns(*pots: int) -> Callable[[Arms], None]:
    return lambda arms: arms.turn(*pots)


def holds(rad: float, apart: float = 0.0) -> Callable[[Arms], None]:
    return lambda arms: arms.hold(rad, apart)


def drifts(counts: float) -> Callable[[Arms], None]:
    def drift(arms: Arms) -> None:
        arms.drift = counts

    return drift


def sweeps(pots: Sequence[int], first: int = 1) -> list[Step]:
    return [(f"Sweep {number} of", turns(pot), DONE) for number, pot in enumerate(pots, first)]


POSES: list[Step] = [(f"Pose {number} of 4", holds(rad), DONE) for number, rad in enumerate((0.0, 0.7, 0.0, -0.4), 1)]


def walk(steps: Sequence[Step], joints: Joints = ALL, patient: bool = True) -> tuple[Script, Walk]:
    arms = Arms()
    script = Script(arms, steps, patient)
    device: Any = arms
    return script, Walk(Watch(device, TABLE, script), joints, poses_asked(np.zeros(4), None, joints), TRACK_RAD)


def test_each_sweep_says_which_joint_of_which_arm_which_way_first_and_how_many() -> None:
    script, way = walk([*sweeps(range(8)), *POSES])
    found, apart = way.go()
    assert script.left == []
    assert found.zero == pytest.approx(500.0, abs=0.1)
    assert apart == pytest.approx(0.0, abs=1e-3)
    for place, told in enumerate(script.asked[:8]):
        name = f"{('leader', 'follower')[place // 4]} joint {place % 4}, {JOINT_NAMES[place % 4]}"
        assert told.startswith(f"Sweep {place + 1} of 8: {name}. Turn it, and no other, slowly to its positive end")
        assert f"({POSITIVE_WAYS[place % 4]}), then to its negative end" in told
    assert script.asked[8] == "Pose 1 of 4: hold both arms in this pose: every joint at 0 (stretched out, level)."
    assert script.shown[0].startswith("leader potentiometer 0 reads ")
    assert script.shown[-1] == "leader 422 422 422 422, follower 422 422 422 422 of 1023"


def test_back_goes_to_the_step_before_also_from_a_pose() -> None:
    script, way = walk(
        [
            ("Sweep 1 of 2: leader joint 0", rest, BACK),
            ("Sweep 1 of 2: leader joint 0", turns(0), DONE),
            ("Sweep 2 of 2: follower joint 0", turns(0), BACK),  # what moved until then does not count
            *sweeps([0, 4]),
            ("Pose 1 of 4", rest, BACK),
            ("Sweep 2 of 2: follower joint 0", turns(4), DONE),
            *POSES,
            ("Pose 4 of 4", holds(-0.5), DONE),
        ],
        joints=(0,),
    )
    way.go()
    assert script.told[0] == "This is the first step."
    way.go(way.length - 1)
    assert script.left == []


def test_again_forgets_what_moved_in_this_sweep() -> None:
    script, way = walk([("Sweep 1", turns(2), AGAIN), *sweeps([0, 4]), *POSES], joints=(0,))
    way.go()
    assert not any("did not move" in told for told in script.told)


def test_a_sweep_is_put_off_until_the_others_are_done_and_a_pose_cannot_be() -> None:
    script, way = walk(
        [
            ("Sweep 1 of 2: leader joint 0", rest, SKIP),
            ("Sweep 1 of 2: follower joint 0", turns(4), DONE),
            ("Sweep 2 of 2: leader joint 0", rest, SKIP),
            ("Sweep 2 of 2: leader joint 0", turns(0), DONE),
            ("Pose 1 of 4", rest, SKIP),
            *POSES,
        ],
        joints=(0,),
    )
    way.go()
    assert script.told == ["All two potentiometers turn with their joints.", "A pose cannot wait."]
    assert script.left == []


def test_many_mistakes_in_one_sweep_lose_no_other() -> None:
    wrong: list[Step] = [("Sweep 2 of 2", rest, DONE), ("Follower joint 0, base yaw: mend it", rest, DONE)]
    script, way = walk(
        [
            *sweeps([0]),
            *(wrong * (CALIBRATION.script_tries + 2)),
            wrong[0],
            ("Follower joint 0, base yaw: mend it", rest, BACK),
            *sweeps([0, 4]),
            *POSES,
        ],
        joints=(0,),
    )
    way.go()
    assert script.left == []
    assert sum("did not move: check that its shaft" in told for told in script.told) == CALIBRATION.script_tries + 3


@pytest.mark.parametrize("patient", [True, False])
def test_a_pose_that_contradicts_what_was_before_comes_again_for_a_person(patient: bool) -> None:
    """The third one is not the first one again; the fourth one is held differently by the arms."""
    steps: list[Step] = [*POSES[:2], ("Pose 3 of 4", holds(-0.4), DONE)]
    again: list[Step] = [
        ("Pose 3 of 4", holds(-0.4), BACK),
        *POSES[1:3],
        ("Pose 4 of 4", holds(-0.4, 0.5), DONE),
        POSES[3],
    ]
    script, way = walk([*sweeps([0, 4]), *steps, *(again if patient else [])], (0,), patient)
    if patient:
        way.go()
        assert "leader potentiometer 0 (by " in script.told[-2]
        assert ", follower potentiometer 0 (" in script.told[-2]
        assert "leader and follower differ by 0.50 rad at joint 0" in script.told[-1]
        assert all(told.endswith("This pose comes again; b goes back to an earlier step.") for told in script.told[-2:])
    else:
        with pytest.raises(UserError, match="port: elsewhere than in the first pose: leader potentiometer 0 "):
            way.go()
    assert script.left == []


def test_a_script_makes_a_mistake_but_a_few_times() -> None:
    script, way = walk(
        [*sweeps([0]), *([("Sweep 2 of 2", rest, DONE)] * CALIBRATION.script_tries)], joints=(0,), patient=False
    )
    with pytest.raises(UserError, match="port: Follower potentiometer 0 reads 500 to 500 of 1023 and did not move"):
        way.go()
    assert script.left == []


def test_wires_that_are_exchanged_while_one_mends_accuse_nobody() -> None:
    """Else both move at once, and the next sentence accuses the one before."""
    script, way = walk(
        [
            ("Sweep 1 of 4", turns(1), DONE),
            ("Leader joint 0, base yaw: mend it", turns(0, 1), DONE),
            *sweeps([0, 1, 4, 5]),
            *POSES,
        ],
        joints=(0, 1),
    )
    way.go()
    assert len(script.told) == 2
    assert "leader potentiometer 1 did: their wires are swapped" in script.told[0]


@pytest.mark.parametrize("patient", [True, False])
def test_arms_that_drift_are_asked_to_hold_still_a_person_as_often_as_it_takes(patient: bool) -> None:
    drifting: list[Step] = [("Pose 1 of 4", drifts(0.02), DONE)] * CALIBRATION.script_tries
    script, way = walk([*sweeps([0, 4]), *drifting, ("Pose 1 of 4", drifts(0.0), DONE), *POSES[1:]], (0,), patient)
    if patient:
        way.go()
        assert script.left == []
    else:
        with pytest.raises(UserError, match="port: the arms were not held still"):
            way.go()
    assert "Leader potentiometer 0 moved by 8 counts; hold both arms still." in script.told
