"""One who shares the board through the relay, a page or a verb that runs for one, and what a stop means for it.

After a stop no motor starts until a person asks anew. So a verb that ran then starts none any more, and what a page
asked for before it, and sends again because no answer came, is refused.
"""

from __future__ import annotations

import secrets
from collections.abc import Callable

from greywhale.dashboard.outbox import Outbox
from greywhale.protocol import schema
from greywhale.protocol.frames import Frame, FrameDecoder

STARTS = {schema.EnableRequest.TYPE, schema.LeadRequest.TYPE}
_REQUEST_NUMBERS = 255  # of requests, which count 1..255


class Client:
    """`verb` marks a verb that runs for a page, the job `id`: it keeps its lease itself.

    A verb's outbox gets a message in words once: when the board is gone. `end` is called with a sentence, from any
    thread, when it is to end as by Ctrl-C.
    """

    def __init__(
        self,
        outbox: Outbox,
        verb: str | None = None,
        id: str | None = None,
        end: Callable[[str], None] = lambda sentence: None,
    ) -> None:
        self.id = id or secrets.token_hex(8)
        self.outbox = outbox
        self.verb = verb
        self.every = 0  # ticks between the samples it gets; 0: none
        self.seen_s = 0.0
        self.decoder = FrameDecoder()
        self._end = end
        self._stopped: str | None = None  # why a verb starts no motor any more
        self._refused = 0  # starts of a stopped verb
        self._newest: int | None = None  # number of a page's newest request
        self._start: int | None = None  # that of its newest start, unless a stop came after it

    def note(self, frame: Frame) -> None:
        """A page asks for something; what it sends again has the number of before."""
        if self._newest is None or 0 < (frame.seq - self._newest) % _REQUEST_NUMBERS <= _REQUEST_NUMBERS // 2:
            self._newest = frame.seq
            if frame.type in STARTS:
                self._start = frame.seq

    def forbid(self, sentence: str = "") -> bool:
        """A verb starts no motor from now on, and a page none that it has asked for; False where that was so before."""
        self._start = None
        if self.verb is None or self._stopped is not None:
            return False
        self._stopped = sentence
        return True

    def stop(self, sentence: str) -> None:
        """Refuse requests, and end a verb. Once: a second Ctrl-C would not let it write its files."""
        if self.forbid(sentence):
            self._end(sentence)

    def refuses(self, frame: Frame) -> str:
        """The reason why it may not start the motors, in a sentence."""
        if self.verb is None:
            return "" if frame.seq == self._start else "a stop came after this; ask again for the motors."
        if self._stopped is None:
            return ""
        self._refused += 1
        if self._refused > 1:  # it goes on, so the first Ctrl-C did not reach it
            self._end(self._stopped)
        return self._stopped or "it was stopped; start the verb again."
