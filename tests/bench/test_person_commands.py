"""The person's hands as commands: a whole sweep, a pose in degrees, an arm that hangs, and answers in words."""

from __future__ import annotations

import os
from collections.abc import Iterator

import numpy as np
import pytest

from greywhale.base.errors import UserError
from greywhale_sim import commands
from greywhale_sim.bench import Bench
from greywhale_sim.pacing import Pacer
from greywhale_sim.person_commands import ENDS_DEG, HANGING_DEG, HELP
from greywhale_sim.serial_port import SerialPort
from greywhale_sim.serve import ByHand
from greywhale_sim.server import Server


@pytest.fixture
def server(bench: Bench) -> Iterator[Server]:
    server = Server(bench, SerialPort(), fast=True, pacer=Pacer(lambda: 0.0, lambda seconds: None))
    yield server
    server.close()


def arms(bench: Bench) -> np.ndarray:
    """Leader and follower (2, 4), degrees."""
    assert bench.leader.hold is not None
    return np.degrees([bench.leader.angles, bench.leader.hold])


@pytest.mark.parametrize(("side", "row"), [("leader", 0), ("follower", 1)])
def test_a_turn_goes_to_the_positive_end_first_then_to_the_other_and_back(server: Server, side: str, row: int) -> None:
    bench, seen = server.bench, []
    before = arms(bench)
    answer = commands.run(server, f"turn {side} 2 0.1")
    assert answer["says"].startswith(f"{side} joint 2, wrist pitch, turns to 75 and then to -70 degrees, and back; ")
    while bench.time_s < answer["arrives_s"]:
        bench.run_slices(4)
        seen.append(arms(bench))
    ways = np.array(seen)
    swept = ways[:, row, 2]
    assert (swept.max(), swept.min()) == pytest.approx(ENDS_DEG)
    assert swept.argmax() < swept.argmin()
    ways[:, row, 2] = before[row, 2]
    assert ways == pytest.approx(np.tile(before, (len(ways), 1, 1))), "nothing else moves"
    bench.run(0.01)
    assert arms(bench) == pytest.approx(before)


def test_a_pose_has_one_angle_for_all_joints_or_four_and_the_follower_hangs_alone(server: Server) -> None:
    for words, pose in (("30", [30.0] * 4), ("60 50 -45 40", [60.0, 50.0, -45.0, 40.0])):
        commands.run(server, f"hold {words}")
        server.bench.run(1.1)
        assert arms(server.bench) == pytest.approx(np.tile(pose, (2, 1)))
    commands.run(server, "hang")
    server.bench.run(1.1)
    assert arms(server.bench) == pytest.approx(np.array([pose, HANGING_DEG]))


@pytest.mark.parametrize("words", ["turn both 0", "turn leader 4", "turn leader 0 0", "hold", "hold 1 2 3", "hold 400"])
def test_what_no_hand_can_do_is_refused_with_its_form(server: Server, words: str) -> None:
    with pytest.raises(UserError, match=f"is not understood; say: {words.split()[0]} "):
        commands.run(server, words)


def test_hands_that_turn_a_joint_are_not_sent_on_another_turn(server: Server) -> None:
    server.bench.run(0.01)
    commands.run(server, "turn leader 0 0.1")
    with pytest.raises(UserError, match="wait until they are there"):
        commands.run(server, "turn leader 0 0.1")
    server.bench.run(1.0)
    commands.run(server, "turn leader 0 0.1")


def test_a_person_is_answered_in_words_and_told_when_the_hands_are_there(
    server: Server, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    out, into = os.pipe()
    with os.fdopen(out) as stdin:
        monkeypatch.setattr("sys.stdin", stdin)
        person = ByHand(server)

        def say(words: str) -> list[str]:
            os.write(into, f"{words}\n".encode())
            person.look()
            return capsys.readouterr().out.splitlines()

        assert say("hold 10") == ["both arms go to 10 degrees; 1 s."]
        assert say("fly")[0].startswith('"fly" is not a bench command; there are: ')
        assert "leader_plays: 0" in say("status")
        assert say("help") == HELP.splitlines()
        server.bench.run(1.0)
        assert say("estop press") == ["There.", "estop_pressed: True"]
        assert say("estop release") == ["estop_pressed: False"]
        assert say("clutch press") == ["clutch_pressed: True"]
        os.close(into)
        person.look()
    assert server.ending, "the end of the input ends the bench"
