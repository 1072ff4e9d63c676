"""A ticket gets the token once, and not late: by a clock of the test's own."""

from __future__ import annotations

from greywhale.dashboard.access import Access
from greywhale.dashboard.limits import REQUESTS


class Clock:
    now_s = 0.0

    def __call__(self) -> float:
        return self.now_s


def ticket_of(address: str, port: int = 80) -> str:
    start = f"http://127.0.0.1:{port}/#ticket="
    assert address.startswith(start)
    return address.removeprefix(start)


def test_each_ticket_counts_once() -> None:
    access = Access(80)
    first, second = ticket_of(access.address()), ticket_of(access.address())
    for ticket in (second, first):
        assert access.exchange(ticket) == access.token
        assert access.exchange(ticket) is None


def test_a_ticket_is_void_when_its_time_is_over() -> None:
    clock = Clock()
    access = Access(80, clock)
    first, second = ticket_of(access.address()), ticket_of(access.address())
    clock.now_s = REQUESTS.ticket_lasts_s
    assert access.exchange(first) == access.token
    clock.now_s = REQUESTS.ticket_lasts_s + 1.0
    assert access.exchange(second) is None
    assert access.exchange(ticket_of(access.address())) == access.token


def test_what_is_no_ticket_gets_nothing() -> None:
    access = Access(80)
    ticket = ticket_of(access.address())
    for wrong in ("", "x", ticket[:-1], ticket + "x", ticket.swapcase(), access.token, "é" * 40):
        assert access.exchange(wrong) is None
    assert access.exchange(ticket) == access.token


def test_of_many_unused_tickets_the_newest_count() -> None:
    access = Access(80)
    tickets = [ticket_of(access.address()) for _ in range(REQUESTS.most_tickets + 3)]
    assert [access.exchange(one) is not None for one in tickets] == [False] * 3 + [True] * REQUESTS.most_tickets


def test_an_address_says_nothing_of_the_token() -> None:
    access = Access(80)
    assert access.token not in access.address()
    assert access.token != Access(80).token
