"""How long a tick may take when the main loop is busy as it should begin: a piece of work, the tick, and all interrupts
that may come meanwhile.

Times are cycles after the timer's interrupt of the tick in which the piece begins.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, replace

from tools.timing.facts import Piece
from tools.timing.image import BYTE, CONVERSION, CONVERSIONS, HELD, PERIOD, RING, SENT, Times

CHAIN = 33 * 64  # hal's chain_start
FRAME = 54  # bytes: wire::max_wire, what a piece may add to those that wait to be sent
LEAVE = 120  # cycles from tx_write() through the ends of the functions to tick_begin(): about 100
MICROSECOND = 16
NO_BOUND = 20 * PERIOD
CALM_TICKS = 4  # requests.cpp


@dataclass(frozen=True)
class Line:
    """Whether bytes come, and are sent, without a gap."""

    receiving: bool
    sending: bool


QUIET, FULL = Line(receiving=False, sending=False), Line(receiving=True, sending=True)
SENDING, RECEIVING = Line(receiving=False, sending=True), Line(receiving=True, sending=False)


@dataclass(frozen=True)
class Work:
    """A piece of the main loop: when it begins at the latest, its own cycles, what it reads, whether it sends."""

    begins: int
    cycles: int
    reads: int = 0
    sends: bool = False


def works(times: Times, pieces: Mapping[str, Piece], line: Line) -> dict[str, Work]:
    """The pieces of an image, and looks with a request behind them in the same call.

    A look begins where a tick has ended that nothing has delayed, or later: behind the host's lead, or behind a tick
    that other work has delayed. While a request may delay ticks no other begins late (calm_ticks in requests.cpp).
    """
    after = times.response(line.receiving) or PERIOD
    found = {
        name: Work(
            after if piece.begins is None else piece.begins * MICROSECOND, times.pieces[name], piece.reads, piece.sends
        )
        for name, piece in pieces.items()
    }
    both = replace(found["request"], begins=after, cycles=times.pieces["look"] + times.pieces["request"])
    found["look, request"] = both
    latest = _latest_look(times, found, line)
    if latest is not None:
        found["late look, request"] = replace(both, begins=latest)
    return found


def _latest_look(times: Times, found: Mapping[str, Work], line: Line) -> int | None:
    """When a look begins at the latest that a request may follow late. None where a tick may be late.

    With the motors on: nothing is applied, and no bytes are lost. The safe set's restart and the host's lead exclude
    each other.
    """
    look, lead, request = (found[name] for name in ("look", "lead", "request"))
    without = _latest(times, [look, found["answer"], found["restart"]], line)
    begins, before = without, -1
    while begins != before:
        before = begins
        both = replace(request, begins=begins, cycles=look.cycles + request.cycles)
        delayed = _latest(times, [request, both], line)
        if max(delayed, begins) > PERIOD:
            return None
        for _ in range(CALM_TICKS):
            behind = _ready(times, replace(lead, begins=min(delayed, PERIOD - 1)), line) or NO_BOUND
            moved = [replace(lead, begins=delayed), replace(look, begins=behind), found["answer"]]
            delayed = _latest(times, moved, line)
        begins = max(without, _ready(times, replace(lead, begins=delayed), line) or NO_BOUND)
    return begins


def _latest(times: Times, works: Sequence[Work], line: Line) -> int:
    return max(end_of_tick(times, work, line) or NO_BOUND for work in works)


def _ready(times: Times, piece: Work, line: Line) -> int | None:
    """The end of a piece itself, before any tick."""
    return _settle(piece.begins, lambda now: piece.begins + piece.cycles + _interrupts(times, piece, line, now, now))


def end_of_tick(times: Times, piece: Work, line: Line) -> int | None:
    """The end of the tick after a piece, in cycles after the timer's interrupt with which that tick was due.

    More than PERIOD is late, also when the piece itself goes on for longer than that. None: there is no bound.
    """
    begin = min(piece.begins, PERIOD - 1)
    piece = replace(piece, begins=begin)
    ready = _ready(times, piece, line)
    if ready is None:
        return None
    if ready <= PERIOD:  # the piece has ended before
        return times.response(line.receiving)
    both = piece.cycles + times.tick
    end = _settle(ready, lambda now: begin + both + _interrupts(times, piece, line, now, ready))
    return None if end is None else end - PERIOD


def _settle(start: int, step: Callable[[int], int]) -> int | None:
    """The first moment at which all that may have come until then is done."""
    now = start
    while now < NO_BOUND:
        later = step(now)
        if later <= now:
            return now
        now = later
    return None


def _interrupts(times: Times, piece: Work, line: Line, now: int, tick: int) -> int:
    """Cycles of the interrupts from the begin of the piece until now; nothing is sent once the tick has begun.

    What was due when the piece began may come after that: one conversion, and what the chip holds of the line. The
    receiver's interrupt takes a byte, or it finds the ring full and waits for the next byte that is read.
    """
    during = {kind: cycles - times.waking for kind, cycles in times.interrupts.items()}
    length, found = now - piece.begins, 0
    found += _between(piece.begins, now, PERIOD) * during["tick's interrupt"]
    found += _between(piece.begins - CHAIN, now - CHAIN, PERIOD) * during["start of the chain"]
    found += _conversions(piece.begins, now) * during["conversion done"]
    if line.receiving:
        taken = min(RING + piece.reads, math.ceil(length / BYTE) + HELD)
        found += (taken + 1 + piece.reads) * during["byte received"]
    if line.sending:
        sent = min(RING + FRAME, math.ceil(min(length, tick - piece.begins) / BYTE) + SENT)
        found += sent * during["byte sent"]
    elif piece.sends:
        found += _answered(during, line) * during["byte sent"]
    return found


def _answered(during: Mapping[str, int], line: Line) -> int:
    """How many bytes of what a piece sends may go out before the tick, when nothing else does."""

    def left(now: int) -> int:
        time = LEAVE + max(during["tick's interrupt"], during["start of the chain"])
        time += (math.ceil(now / BYTE) + SENT) * during["byte sent"]
        time += (math.ceil(now / CONVERSION) + 1) * during["conversion done"]
        return time + line.receiving * (math.ceil(now / BYTE) + HELD + 1) * during["byte received"]

    time = _settle(LEAVE, left)
    return FRAME if time is None else min(FRAME, math.ceil(time / BYTE) + SENT)


def _between(start: int, end: int, every: int) -> int:
    """How many multiples are above `start`, and not above `end`."""
    return end // every - start // every


def _conversions(start: int, end: int) -> int:
    ends = (chain + n * CONVERSION for chain in range(CHAIN, end, PERIOD) for n in range(1, CONVERSIONS + 1))
    return sum(start - CONVERSION < at <= end for at in ends)
