"""Records episodes of a task, a log each: a person begins and ends them while the board's samples go on.

Between two of them the motors stay as they are, so with `enable` the follower follows while the scene is set up anew.
An error or Ctrl-C ends all: the motors go off first, then the running episode is kept, marked as interrupted.
"""

from __future__ import annotations

import contextlib
from collections.abc import Callable, Iterator
from dataclasses import dataclass, replace
from enum import Enum, auto
from pathlib import Path

from greywhale.base.errors import UserError, os_reason
from greywhale.base.types import NotedProgress, show_no_progress
from greywhale.board.device import Device
from greywhale.board.limits import RECORDING
from greywhale.board.record import Recording, check_request, origin_of, samples_of, write_samples
from greywhale.board.stream import Received, why_stopped
from greywhale.board.upload import read_parameters
from greywhale.files.log.episodes import next_episode
from greywhale.files.log.writer import LogWriter
from greywhale.protocol import schema


class Wish(Enum):
    """A wish of the person who records."""

    NEXT = auto()  # begin an episode, or end the one that runs
    DISCARD = auto()  # the one that runs, or else the last one of this session
    END = auto()  # of all


@dataclass(frozen=True)
class EpisodePlan:
    """The episodes asked for: `count` at most, `seconds` each at most by the board's clock (None: as long as wished),
    one sample every `every` ticks of 1 ms, with `enable` perhaps `disengaged` first.
    """

    folder: Path
    task: str
    count: int
    seconds: float | None
    every: int = 1
    enable: bool = False
    disengaged: bool = False


@dataclass(frozen=True)
class Episodes:
    """The episodes that were kept, and the number of those that were not."""

    kept: tuple[Recording, ...]
    discarded: int


class Person:
    """Begins and ends the episodes; this one lets the time end each, and begins the next at once."""

    def wish(self, running: bool) -> Wish | None:
        """A wish, None for none: asked at each sample, and told whether an episode is `running`."""
        return None if running else Wish.NEXT

    def tell(self, sentence: str) -> None:
        """Say what became of an episode."""

    def step(self, name: str, running: bool) -> str:
        """The step to show: the episode `name` runs, or comes next; "" where as many are there as were asked for."""
        return f"recording {name}"


def record_episodes(device: Device, plan: EpisodePlan, person: Person, progress: NotedProgress) -> Episodes:
    """Record episodes into the folder of the plan, which is there, until their count is reached or the person ends it.

    The numbers go on after those in the folder. UserError where the motors went off, a log cannot be written, or the
    link fails; the message says what was kept.
    """
    check_request(RECORDING.longest_s if plan.seconds is None else plan.seconds, plan.every, plan.enable)
    origin = replace(origin_of(device, read_parameters(device), plan.every), task=plan.task)
    kept: list[Recording] = []
    discarded = 0
    with contextlib.ExitStack() as motors:
        lease_ms = RECORDING.busy_lease_ms if plan.enable else 0  # to have a log on the disk may take a moment
        received = motors.enter_context(samples_of(device, plan.every, lease_ms, plan.disengaged, progress))
        while True:
            path, full = next_episode(plan.folder), len(kept) == plan.count
            report = _reports(progress, plan, len(kept))
            report(person.step("" if full else path.name, False))
            wish: Wish | None = _wait(device, received, person, plan.enable)
            if wish is Wish.NEXT and full:
                break
            if wish is Wish.NEXT:
                report(person.step(path.name, True))
                with LogWriter(path, origin) as log, _stopping(motors):
                    recording, wish = _record(device, log, received, person, plan)
                kept.append(recording)
                if wish is not Wish.DISCARD:
                    person.tell(f"{path}: {recording.duration_s:g} s, kept.")
            if wish is Wish.DISCARD and kept:
                path = kept.pop().path
                _remove(path)
                discarded += 1
                person.tell(f"{path}: discarded.")
            if wish is Wish.END:
                break
    device.telemetry(0)
    return Episodes(tuple(kept), discarded)


@contextlib.contextmanager
def _stopping(motors: contextlib.ExitStack) -> Iterator[None]:
    """Stop the motors before the log of an episode that an error or Ctrl-C ended is on the disk."""
    try:
        yield
    except BaseException as error:
        motors.__exit__(type(error), error, error.__traceback__)
        raise


def _reports(progress: NotedProgress, plan: EpisodePlan, kept: int) -> Callable[[str], None]:
    return lambda step: progress(step, kept / plan.count, f"{kept} of {plan.count} kept")


def _wait(device: Device, received: Iterator[Received], person: Person, enabled: bool) -> Wish:
    """The next wish, while samples come that nobody records."""
    for one in received:
        if enabled and one.sample.state is not schema.State.FOLLOWING:
            raise why_stopped(device)
        wish = person.wish(False)
        if wish is not None:
            return wish
    raise AssertionError("a stream of samples has no end")


def _record(
    device: Device, log: LogWriter, received: Iterator[Received], person: Person, plan: EpisodePlan
) -> tuple[Recording, Wish | None]:
    """Fill the log of an episode; the wish that ended it, None where its time did."""
    wishes: list[Wish] = []

    def ended() -> bool:
        wish = person.wish(True)
        if wish is not None:
            wishes.append(wish)
        return bool(wishes) and log.rows >= 2  # a reader needs two to know how far they are apart

    length = round(1000 * (RECORDING.longest_s if plan.seconds is None else plan.seconds))
    duration = write_samples(device, log, received, length, plan.enable, show_no_progress, ended=ended)
    return Recording(log.path, log.rows, log.dropped, duration), wishes[0] if wishes else None


def _remove(path: Path) -> None:
    try:
        path.unlink(missing_ok=True)
    except OSError as error:
        raise UserError(f"{path}: cannot be discarded: {os_reason(error)}; delete it yourself.") from None
