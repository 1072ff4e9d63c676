"""The tick with the interrupts that may come, from bounds that are easy to add by hand."""

from __future__ import annotations

from tools.timing import delay
from tools.timing.facts import Piece
from tools.timing.image import PERIOD, Times

KINDS = {
    "tick's interrupt": 10,
    "start of the chain": 10,
    "conversion done": 20,
    "byte received": 50,
    "byte sent": 30,
}


def test_interrupts_add_to_the_tick_as_often_as_they_may_come() -> None:
    quiet = {
        "tick's interrupt": 10,
        "start of the chain": 10,
        "conversion done": 20,
        "byte received": 50,
        "byte sent": 30,
    }
    bounds = Times(tick=1000, interrupts=quiet, waking=0)
    assert bounds.response(receiving=False) == 1020 + 2 * 30
    assert bounds.response(receiving=True) == 1080 + (11 + 2) * 50
    longer = Times(tick=3000, interrupts=quiet, waking=0)
    assert longer.response(receiving=False) == 3080 + 2 * 20
    full = Times(tick=1000, interrupts=quiet | {"byte received": 161}, waking=0)
    assert full.response(receiving=True) is None


def test_a_piece_that_ends_before_the_tick_does_not_delay_it() -> None:
    bounds = Times(tick=1000, interrupts=KINDS, waking=0)
    for line in (delay.QUIET, delay.RECEIVING):
        end = delay.end_of_tick(bounds, delay.Work(8000, 1000), line)
        assert end == bounds.response(line.receiving)


def test_a_piece_delays_the_tick_by_what_is_left_of_it_and_all_interrupts_since_it_began() -> None:
    bounds = Times(tick=1000, interrupts=KINDS, waking=0)
    # From 15,600 to the tick's interrupt; the chain's last conversion ended at 15,424 and may just be due.
    assert delay.end_of_tick(bounds, delay.Work(15_600, 700), delay.QUIET) == 300 + 1000 + 10 + 20
    # The chain begins 2,112 cycles after it, and its first conversion ends 416 later.
    assert delay.end_of_tick(bounds, delay.Work(15_600, 1800), delay.QUIET) == 1400 + 1000 + 2 * 10 + 20
    assert delay.end_of_tick(bounds, delay.Work(15_600, 1900), delay.QUIET) == 1500 + 1000 + 2 * 10 + 2 * 20
    # What is sent ends with the piece: 738 + 10 * 30 cycles from its begin, so 7 bytes and the 2 that the chip takes.
    assert delay.end_of_tick(bounds, delay.Work(15_600, 700), delay.SENDING) == 300 + 1000 + 10 + 20 + 9 * 30
    # 4,400 cycles with 28 bytes, 2 in the chip, and an interrupt that finds the ring full.
    received = delay.end_of_tick(bounds, delay.Work(15_600, 700), delay.RECEIVING)
    assert received is not None
    taken = -(-(received + 400) // 160) + 2 + 1
    assert received == 300 + 1000 + 10 + 20 + taken * 50 + 10 * (received > 2112) + 20 * (received > 2528)


def test_what_a_piece_sends_goes_out_before_the_tick_also_on_a_quiet_line() -> None:
    bounds = Times(tick=1000, interrupts=KINDS, waking=0)
    silent = delay.end_of_tick(bounds, delay.Work(15_600, 700), delay.QUIET)
    sends = delay.end_of_tick(bounds, delay.Work(15_600, 700, sends=True), delay.QUIET)
    assert silent is not None
    # 120 cycles, the tick's interrupt, two conversions and 4 bytes take 290: two bytes at once, one each 160 cycles.
    assert sends == silent + 4 * 30


def test_a_piece_may_outlast_a_period_or_never_end() -> None:
    bounds = Times(tick=1000, interrupts=KINDS, waking=0)
    long = delay.end_of_tick(bounds, delay.Work(4864, 30_000), delay.QUIET)
    assert long is not None
    assert long > PERIOD
    flooded = Times(tick=1000, interrupts=KINDS | {"conversion done": 600}, waking=0)
    assert delay.end_of_tick(flooded, delay.Work(12_000, 5000), delay.QUIET) is None


WORK = {"look": 500, "request": 700, "lead": 200, "answer": 300, "restart": 400}
PIECES = {
    "look": Piece((), None, 0, sends=False),
    "request": Piece((), 1000, 20, sends=False),
    "lead": Piece((), 1000, 0, sends=False),
    "answer": Piece((), 800, 0, sends=False),
    "restart": Piece((), 1000, 0, sends=False),
}


def test_a_look_begins_where_the_tick_has_ended_and_a_request_may_follow() -> None:
    works = delay.works(Times(tick=1000, interrupts=KINDS, waking=0, pieces=WORK), PIECES, delay.QUIET)
    assert works["look"] == delay.Work(1080, 500)
    assert works["request"] == delay.Work(PERIOD, 700, 20)
    assert works["look, request"] == delay.Work(1080, 1200, 20)
    # The restart delays a tick by more than the rest; and from the last cycle of a period it begins with it.
    assert works["late look, request"] == delay.Work(1000 + 400 + 10 - 1, 1200, 20)


def test_where_a_tick_may_be_late_there_is_no_bound_behind_it() -> None:
    times = Times(tick=1000, interrupts=KINDS, waking=0, pieces=WORK | {"request": 15_100})
    assert "late look, request" not in delay.works(times, PIECES, delay.QUIET)


def test_the_hosts_lead_comes_between_a_tick_and_its_look() -> None:
    times = Times(tick=1000, interrupts=KINDS, waking=0, pieces=WORK | {"lead": 2000})
    late = delay.works(times, PIECES, delay.QUIET)["late look, request"]
    assert 1080 + 2000 <= late.begins < 1080 + 2000 + 200  # and some interrupts
