"""Limits of the dashboard: whom it lets in, how much it takes and keeps, and how long it waits for pages and boards."""

from __future__ import annotations

from dataclasses import dataclass

from greywhale.base.limits import limit


@dataclass(frozen=True)
class ConnectionLimits:
    """Connections, and who of those that hold no token stays."""

    backlog: int = limit(
        4096, "connections", "kept by the system at no cost; with fewer, new pages would wait a second"
    )
    accepted: tuple[float, float] = limit(
        (1000.0, 16.0), "a second, at once", "who sends at once is heard before others push it out"
    )
    handed: tuple[float, float] = limit((200.0, 64.0), "a second, at once", "a program may open one for each request")
    without_descriptors_s: float = limit(1.0, "s", "until the next try; the system's are closed within seconds")
    most_strangers: int = limit(64, "without the token", "a page that loads opens six, and some browsers a few more")
    fewest_strangers: int = limit(6, "without the token", "one loading page; also with few descriptors")
    most_known: int = limit(64, "with the token", "a page has two, and more for a moment while it asks for something")
    patience_s: float = limit(10.0, "s", "a stranger is closed: a browser that opens beforehand uses it within seconds")
    grace_s: float = limit(2.0, "s", "a stranger that asks for something is not closed for another one")
    moment_s: float = limit(0.05, "s", "nor one that has just come: a browser says in a millisecond what it wants")


@dataclass(frozen=True)
class RequestLimits:
    """Requests and messages of pages."""

    ticket_lasts_s: float = limit(600.0, "s", "to paste an address, also through a tunnel from another machine")
    most_tickets: int = limit(16, "tickets", "kept unused; older ones are forgotten")
    most_body_bytes: int = limit(1 << 20, "bytes", "of a request: the words of a verb take 100 kB at most")
    most_upload_bytes: int = limit(1 << 27, "bytes", "a log of ten minutes has some 70 MB")
    most_message_bytes: int = limit(1 << 16, "bytes", "frames of the link are 50; a page sends some at once")
    owners: tuple[float, float] = limit((100.0, 300.0), "a second, at once", "a page asks for ten things at its start")
    strangers: tuple[float, float] = limit(
        (100.0, 100.0), "a second, at once", "without the token: who comes too early waits"
    )
    messages: tuple[float, float] = limit(
        (400.0, 2000.0), "a second, at once", "a page that leads sends a point each 16 ms"
    )
    most_values: int = limit(100, "values", "of one argument, such as the logs of `evaluate`")
    longest_value_letters: int = limit(1000, "letters", "of a value: a path is shorter")
    most_files: int = limit(1000, "files", "looked at, in and below the folder")
    largest_table_bytes: int = limit(1 << 20, "bytes", "a larger TOML table is nobody's that a page would name")


@dataclass(frozen=True)
class JobLimits:
    """Verbs that a page runs."""

    most_running: int = limit(4, "verbs", "each may keep a processor busy")
    most_kept: int = limit(50, "verbs", "the oldest that have ended are forgotten")
    most_said_lines: int = limit(200, "lines", "kept of a verb's output, the newest")
    end_wait_s: float = limit(15.0, "s", "an interrupted verb stops motors and writes files; longer, it hangs")


@dataclass(frozen=True)
class SampleLimits:
    """Samples and answers that are kept for who has not read them, and how often they go out."""

    history: int = limit(600_000, "samples", "ten minutes of every tick")
    lent: int = limit(60_000, "samples", "a verb may compute for a minute before it reads, and loses none")
    outbox: int = limit(10_000, "samples", "a page that reads later loses the oldest pictures; the history has them")
    most_answers: int = limit(4096, "answers", "a client that takes none is beyond help")
    batch_s: float = limit(0.02, "s", "samples of so long go out in one message")
    torque_s: float = limit(0.04, "s", "torques go out so often: more, nobody sees or hears")


@dataclass(frozen=True)
class BoardLimits:
    """The board, the page that drives it, and their silences."""

    look_again_s: float = limit(0.5, "s", "until a board is looked for again")
    after_stop_s: float = limit(3.0, "s", "until one that was stopped from elsewhere is taken again")
    let_go_s: float = limit(10.0, "s", "a board that is just being greeted keeps its port")
    round_s: float = limit(0.004, "s", "samples are read together: to wake up each tick would cost more than all else")
    answer_s: float = limit(0.03, "s", "a request without an answer was lost; the next one waits for it no longer")
    most_waiting: int = limit(255, "requests", "clients ask again for those that a flood of them pushes out")
    report_silence_s: float = limit(0.5, "s", "a board that says nothing is reported silent")
    ask_again_s: float = limit(6.0, "s", "then it is asked for its samples again")
    give_up_s: float = limit(7.0, "s", "then its port is let go")
    page_silence_s: float = limit(0.5, "s", "the motors go off; a page may be busy for some tenths of a second")
    lease_ms: int = limit(250, "ms", "the board's lease ends the motors if this host hangs")
    renew_s: float = limit(0.06, "s", "three renewals may be lost")
    no_renewal_s: float = limit(0.1, "s", "a board that sent no sample may have restarted: no lease is renewed")


CONNECTIONS = ConnectionLimits()
REQUESTS = RequestLimits()
JOBS = JobLimits()
SAMPLES = SampleLimits()
BOARD = BoardLimits()
