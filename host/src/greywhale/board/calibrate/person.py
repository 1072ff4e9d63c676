"""The person who calibrates, or what stands for one: what is asked, shown and answered while the board is watched."""

from __future__ import annotations

from collections import deque
from collections.abc import Sequence
from dataclasses import dataclass
from enum import Enum
from typing import Protocol

from greywhale.base.errors import UserError
from greywhale.base.types import Floats
from greywhale.board.device import Device
from greywhale.board.limits import CALIBRATION
from greywhale.board.pots import FULL_SCALE, POTS, counts_of
from greywhale.board.refusal import pot_name
from greywhale.board.stream import stream
from greywhale.protocol import schema
from greywhale.protocol.table import ParameterTable


class PersonAnswer(Enum):
    DONE = "done"
    BACK = "the step before"
    AGAIN = "this step again"
    SKIP = "this step later"


class Guide(Protocol):
    """The person, or what stands for one."""

    @property
    def patient(self) -> bool:
        """True if somebody is there who may be asked again and again; a script's lines come to an end."""

    def ask(self, what: str) -> None:
        """Say what to do, to be answered when it is done; what was said before counts no more."""

    def show(self, live: str) -> None:
        """Show what is read right now; the next call replaces it."""

    def answer(self) -> PersonAnswer | None:
        """The answer since `ask`, None before there is one. Raises UserError when none will come, or to end it all."""

    def tell(self, what: str) -> None:
        """Say something that needs no answer."""


@dataclass(frozen=True)
class Watch:
    """Asks a person, and watches the potentiometers of a board that runs `table` until the answer."""

    device: Device
    table: ParameterTable
    guide: Guide

    def ask(self, what: str, pots: Sequence[int]) -> tuple[PersonAnswer, Floats]:
        """The answer, and all counts (rows, 8) until then; these potentiometers are shown meanwhile."""
        self.guide.ask(what)
        samples: deque[schema.Sample] = deque(maxlen=CALIBRATION.longest_ticks)
        try:
            for number, one in enumerate(stream(self.device, 1), 1):
                samples.append(one.sample)
                if number % CALIBRATION.shown_every_ticks == 0:
                    self.guide.show(_reading(counts_of([one.sample], self.table)[0], pots))
                    if answer := self.guide.answer():
                        break
                if number > CALIBRATION.longest_ticks and not self.guide.patient:
                    raise UserError(f"{self.device.port}: nobody has confirmed for ten minutes; begin anew.")
        finally:
            self.device.telemetry(0)
        return answer or PersonAnswer.DONE, counts_of(samples, self.table)


def _reading(counts: Floats, pots: Sequence[int]) -> str:
    """Of one potentiometer with its full name, of several arm by arm."""
    if len(pots) == 1:
        return f"{pot_name(pots[0])} reads {counts[pots[0]]:.0f} of {FULL_SCALE}"
    arms = []
    for side in ("leader", "follower"):
        own = [f"{counts[pot]:.0f}" for pot in pots if POTS[pot].startswith(side)]
        arms += [f"{side} {' '.join(own)}"] if own else []
    return f"{', '.join(arms)} of {FULL_SCALE}"
