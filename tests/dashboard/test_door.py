"""The door decides who stays connected, and who goes when too many come: by a clock of the test's own."""

from __future__ import annotations

from dataclasses import dataclass

import pytest

from greywhale.dashboard.door import Door
from greywhale.dashboard.limits import CONNECTIONS as LIMITS


@dataclass
class Visitor:
    busy: bool = False
    gone: bool = False

    @property
    def waits(self) -> bool:
        return self.busy

    def close(self) -> None:
        self.gone = True


class Entrance:
    """A door with its clock."""

    def __init__(self, most_strangers: int = 3, most_known: int = 2) -> None:
        self.now_s = 0.0
        self.door = Door(most_strangers, most_known, lambda: self.now_s)

    def enter(self, *ports: int, busy: bool = False) -> list[Visitor]:
        visitors = [Visitor(busy) for _ in ports]
        for port, visitor in zip(ports, visitors, strict=True):
            assert self.door.make_room()
            self.door.enter(("127.0.0.1", port), visitor)
            self.now_s += LIMITS.moment_s
        return visitors

    def welcome(self, *ports: int) -> list[bool]:
        return [self.door.welcome(("127.0.0.1", port)) for port in ports]


def test_of_too_many_strangers_the_oldest_idle_ones_go(caplog: pytest.LogCaptureFixture) -> None:
    entrance = Entrance()
    busy = entrance.enter(1, busy=True)
    idle = entrance.enter(2, 3, 4, 5)
    assert [one.gone for one in busy + idle] == [False, True, True, False, False]
    more = entrance.enter(6, 7, busy=True)
    assert [one.gone for one in busy + idle + more] == [False, True, True, True, True, False, False]
    assert len(caplog.messages) == 1


def test_a_stranger_that_waits_for_an_answer_has_its_time_before_another_one_comes_in() -> None:
    entrance = Entrance()
    first = entrance.enter(1, busy=True)
    entrance.now_s = 0.5 * LIMITS.grace_s
    first += entrance.enter(2, 3, busy=True)
    for at_s, goes in (
        (0.9 * LIMITS.grace_s, None),
        (1.1 * LIMITS.grace_s, 0),
        (1.2 * LIMITS.grace_s, None),
        (1.6 * LIMITS.grace_s, 1),
    ):
        entrance.now_s = at_s
        assert entrance.door.make_room() is (goes is not None)
        if goes is not None:
            assert [one.gone for one in first].count(True) == goes + 1
            entrance.enter(4 + goes, busy=True)


def test_a_stranger_that_has_just_come_in_is_not_closed_before_it_can_speak() -> None:
    entrance = Entrance()
    entrance.enter(1, 2, busy=True)
    [silent] = entrance.enter(3)
    entrance.now_s -= 0.5 * LIMITS.moment_s
    assert not entrance.door.make_room()
    assert not silent.gone
    entrance.now_s += 0.5 * LIMITS.moment_s
    assert entrance.door.make_room()
    assert silent.gone


def test_strangers_push_out_nobody_who_has_shown_the_token() -> None:
    entrance = Entrance()
    known = entrance.enter(1, 2)
    assert entrance.welcome(1, 2) == [True, True]
    strangers = entrance.enter(*range(3, 50))
    entrance.now_s = 2.0 * LIMITS.patience_s
    entrance.door.look()
    assert not any(one.gone for one in known)
    assert all(one.gone for one in strangers)


def test_those_with_the_token_are_bounded_by_themselves_and_one_that_goes_makes_room() -> None:
    entrance = Entrance()
    first, *_ = entrance.enter(1, 2, 3)
    assert entrance.welcome(1, 2, 3, 1, 2) == [True, True, False, True, True]
    first.gone = True
    assert entrance.welcome(3) == [True]


def test_a_stranger_has_its_time_and_one_that_waits_for_an_answer_gets_all_of_it() -> None:
    entrance = Entrance()
    [silent], [served] = entrance.enter(1), entrance.enter(2, busy=True)
    entrance.now_s = LIMITS.patience_s
    [late] = entrance.enter(3)
    for at_s, gone in (
        (LIMITS.patience_s, [False, False, False]),
        (1.1 * LIMITS.patience_s, [True, False, False]),
    ):
        entrance.now_s = at_s
        entrance.door.look()
        assert [one.gone for one in (silent, served, late)] == gone
    served.busy = False
    entrance.door.look()
    assert [served.gone, late.gone] == [True, False]


def test_where_descriptors_are_few_half_of_the_strangers_go_and_no_more_come_in() -> None:
    entrance = Entrance(most_strangers=64, most_known=2)
    known = entrance.enter(1, 2)
    entrance.welcome(1, 2)
    strangers = entrance.enter(*range(3, 3 + 4 * LIMITS.fewest_strangers))
    for left in (2 * LIMITS.fewest_strangers, LIMITS.fewest_strangers):
        assert entrance.door.keep_fewer()
        assert [one.gone for one in strangers] == [True] * (len(strangers) - left) + [False] * left
    assert not entrance.door.keep_fewer()
    [new] = entrance.enter(100)
    assert [one.gone for one in strangers].count(False) == LIMITS.fewest_strangers - 1
    assert not any(one.gone for one in (new, *known))


def test_the_same_is_told_once(caplog: pytest.LogCaptureFixture) -> None:
    door = Door()
    for sentence in 1000 * ["one.", "two."]:
        door.log_once(sentence)
    assert caplog.messages == ["one.", "two."]
