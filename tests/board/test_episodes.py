"""Episodes: begun, ended and discarded while the samples go on; every bad end leaves whole files and motors off."""

from __future__ import annotations

from pathlib import Path

import pytest

from greywhale.base.errors import UserError
from greywhale.base.types import show_no_progress
from greywhale.board.episodes import EpisodePlan, Episodes, Person, Wish, record_episodes
from greywhale.board.limits import RECORDING
from greywhale.files.log import read_log, writer
from greywhale.protocol import schema
from greywhale.protocol.schema import Fault, State
from tests.board.fake_board import FakeBoard, Faults, open_device

TASK = 'Put the "cup", then\nthe plate on it'
CTRL_C = "Ctrl-C"


class Scripted(Person):
    """A person with a wish after so many samples each."""

    def __init__(self, *script: tuple[int, Wish | str]) -> None:
        self.script = list(script)
        self.heard = 0
        self.told: list[str] = []

    def wish(self, running: bool) -> Wish | None:
        self.heard += 1
        if not self.script or self.heard < self.script[0][0]:
            return None
        self.heard, (_, wish) = 0, self.script.pop(0)
        if not isinstance(wish, Wish):
            raise KeyboardInterrupt
        return wish

    def tell(self, sentence: str) -> None:
        self.told.append(sentence)


def recorded(board: FakeBoard, person: Person, folder: Path, count: int = 9, seconds: float | None = None) -> Episodes:
    with open_device(board) as device:
        plan = EpisodePlan(folder, TASK, count, seconds, every=1, enable=True)
        return record_episodes(device, plan, person, show_no_progress)


def test_a_person_begins_ends_and_discards_episodes_while_the_arm_follows(tmp_path: Path) -> None:
    person = Scripted(
        *[(100, Wish.NEXT), (300, Wish.NEXT)],
        *[(2500, Wish.NEXT), (200, Wish.DISCARD)],  # while it runs; a pause is longer than a lease
        *[(50, Wish.NEXT), (1, Wish.NEXT), (700, Wish.DISCARD)],  # the last one, of as few rows as can be read
        *[(50, Wish.NEXT), (400, Wish.NEXT), (10, Wish.DISCARD), (10, Wish.DISCARD), (10, Wish.DISCARD)],
        *[(50, Wish.NEXT), (150, Wish.NEXT), (9, Wish.NEXT), (60, Wish.END)],
    )
    (tmp_path / "episode_004.unfinished.csv").touch()
    (tmp_path / "episode_77.csv").touch()
    with FakeBoard() as board:
        made = recorded(board, person, tmp_path)
        assert (board.asked(schema.EnableRequest), board.state) == (1, State.DISABLED)
    files = [tmp_path / f"episode_{number:03}.csv" for number in (5, 6)]
    assert sorted(tmp_path.glob("episode_0*")) == [tmp_path / "episode_004.unfinished.csv", *files]
    assert [one.path for one in made.kept] == files
    assert (made.discarded, person.script) == (4, [])
    for file, one, rows in zip(files, made.kept, (150, 60), strict=True):
        log = read_log(file)
        assert (one.rows, one.duration_s, one.dropped) == (len(log.time), rows / 1000 - 0.001, 0)
        assert abs(len(log.time) - rows) <= 1
        assert (log.time[0], set(log.state), log.complete, log.origin.task) == (0.0, {"following"}, True, TASK)
    assert person.told[0] == f"{files[0]}: 0.299 s, kept."
    assert person.told[1] == f"{files[1]}: discarded."


def test_without_a_person_each_episode_takes_its_time_and_a_later_call_goes_on(tmp_path: Path) -> None:
    with FakeBoard() as board:
        for count in (2, 1):
            made = recorded(board, Person(), tmp_path, count, seconds=0.2)
            assert [(one.rows, one.duration_s) for one in made.kept] == count * [(200, 0.2)]
    assert [path.name for path in sorted(tmp_path.iterdir())] == [f"episode_00{number}.csv" for number in range(3)]


def test_the_last_episode_may_still_be_discarded_when_all_are_there(tmp_path: Path) -> None:
    wishes = (Wish.NEXT, Wish.NEXT, Wish.DISCARD, Wish.NEXT, Wish.NEXT, Wish.NEXT)
    with FakeBoard() as board:
        made = recorded(board, Scripted(*((100, wish) for wish in wishes)), tmp_path, count=1)
    assert ([one.path.name for one in made.kept], made.discarded) == (["episode_000.csv"], 1)


@pytest.mark.parametrize("running", [True, False])
def test_a_fault_ends_all_and_says_so(tmp_path: Path, running: bool) -> None:
    script = [(100, Wish.NEXT), (200, Wish.NEXT), (100, Wish.NEXT)][: 3 if running else 2]
    with FakeBoard(Faults(fault_at=(900, Fault.TRACKING, 1))) as board:
        with pytest.raises(UserError, match=r"\(joint 1\)") as caught:
            recorded(board, Scripted(*script), tmp_path)
        assert board.state in (State.DISABLED, State.FAULT)
    assert read_log(tmp_path / "episode_000.csv").complete
    ended = tmp_path / "episode_001.csv"
    assert ended.exists() is running
    if running:
        assert caught.value.__notes__ == [f"What was recorded is in {ended}, marked as interrupted."]
        log = read_log(ended)
        assert (log.complete, log.ended_by[:60]) == (False, caught.value.message[:60])


def test_ctrl_c_turns_the_motors_off_before_the_episode_is_on_the_disk(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    states: list[State] = []
    with FakeBoard() as board:
        monkeypatch.setattr(writer, "sync", lambda file: states.append(board.state))
        with pytest.raises(KeyboardInterrupt):
            recorded(board, Scripted((100, Wish.NEXT), (RECORDING.busy_lease_ms // 2, CTRL_C)), tmp_path)
    assert states == [State.DISABLED]
    log = read_log(tmp_path / "episode_000.csv")
    assert (log.complete, log.ended_by, log.origin.task) == (False, "Ctrl-C, or a signal to end.", TASK)
