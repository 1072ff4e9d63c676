"""Shares one board among pages and a running verb: passes frames on, keeps the motors' lease for the page that drives.

Every request gets a sequence number of the relay's own and its answer the client's again; nothing else of a frame
changes. The board sends every tick: how many of them a client gets, it says with the usual request, which never
reaches the board. Time is that of the line, so a simulated board may live faster than this machine.
"""

from __future__ import annotations

import threading
from collections.abc import Callable
from typing import NamedTuple

from greywhale.base.errors import UserError
from greywhale.board.refusal import upper_first
from greywhale.dashboard.client import STARTS, Client
from greywhale.dashboard.history import History
from greywhale.dashboard.lease import Due, Lease
from greywhale.dashboard.limits import BOARD
from greywhale.dashboard.members import Members
from greywhale.dashboard.outbox import Message
from greywhale.dashboard.requests import Asked, Requests
from greywhale.dashboard.silence import Silence, Step
from greywhale.dashboard.stored import StoredSet
from greywhale.protocol import schema
from greywhale.protocol.frames import Frame, FrameDecoder, encode_frame
from greywhale.protocol.ports import is_bench
from greywhale.protocol.transport import Line

# What changes nothing, and what must always get through.
_FOR_ALL = {schema.HelloRequest.TYPE, schema.StatusRequest.TYPE, schema.ParamGetRequest.TYPE, schema.StopRequest.TYPE}
_LEASES = {*STARTS, schema.RenewRequest.TYPE}
_PULSED = "the motors run for a pulse, which nothing makes longer; ask again when they are off."
_STATE = 4  # place of the state in a sample's payload


class _Open(NamedTuple):
    line: Line
    port: str
    may_move: Callable[[], None]  # raises where motors must not start


class Wish(NamedTuple):
    """A page's request to start a verb, and its time."""

    page: str
    stops: int  # before it


class Relay:
    """Any thread may call it; one at a time is inside."""

    def __init__(self, history: History) -> None:
        self.history = history
        self._lock = threading.RLock()
        self.members = Members()
        self._board: _Open | None = None
        self._link: Message = {"kind": "link", "open": False, "port": "", "sentence": "", "unflashed": False}
        self._stored = StoredSet()
        self._decoder = FrameDecoder()
        self._requests = Requests()
        self._lease = Lease()  # of the page for which the motors run
        self._silence = Silence()
        self._stops = 0  # asked for by people

    # --- the board --------------------------------------------------------------------------------------------------

    @property
    def link(self) -> Message:
        """The facts on the board that pages get."""
        return self._link

    def open(self, line: Line, port: str, may_move: Callable[[], None]) -> None:
        """A board is there, greeted; `may_move` raises where its motors must not start."""
        with self._lock:
            self._board = _Open(line, port, may_move)
            self._decoder = FrameDecoder()
            self._stored = StoredSet()
            self._requests.begin(line)
            self._lease.end()
            self._want_samples()
            self._tell_link(True, port, "")
            self._tell_stored()

    def close(self, port: str, sentence: str, unflashed: bool = False) -> None:
        """No board is there, and why; `unflashed`: something is, without this host's firmware, or just getting it."""
        with self._lock:
            if self._board is not None:
                self._ask_for_samples(0)  # whoever opens the port next asks for samples by himself
            self._board = None
            self._lease.end()
            if self.members.verb is not None:
                self.members.verb.outbox.add_answer({"kind": "gone"})
            if self._link["sentence"] != sentence or self._link["open"]:
                self._tell_link(False, port, sentence, unflashed)

    def heard(self, data: bytes) -> None:
        with self._lock:
            for frame, wire in self._decoder.feed_wire(data) if self._board is not None else ():
                if frame.type == schema.Sample.TYPE:
                    self._pass_sample(frame, wire)
                    continue
                if frame.type == schema.HelloReply.TYPE and frame.seq == 0:
                    self._note_restart(frame, wire)
                else:
                    self._pass_answer(frame)
                if self._stored.hear(frame):
                    self._tell_stored()

    def look(self) -> None:
        """Keep the lease, or end it. A UserError says that the board is silent for good."""
        with self._lock:
            if self._board is None:
                return
            now_s = self._board.line.clock()
            self._requests.look(now_s)
            self._look_for_samples(now_s)
            page = self._lease.page
            due = self._lease.look(now_s, self._silence.heard_s)
            if page is not None and due is Due.STOP:
                self._stop()
                self._refuse(page, "the motors are off: the page that drives fell silent.")
            elif due is Due.RENEWAL:
                self._requests.send_soon(Asked(schema.RenewRequest.TYPE), schema.RenewRequest(BOARD.lease_ms).pack())

    # --- clients ----------------------------------------------------------------------------------------------------

    def wish(self, page: str) -> Wish:
        """A page asks now for a verb."""
        with self._lock:
            return Wish(page, self._stops)

    def require(self, wish: Wish) -> None:
        """Refuse a verb whose page drives no more, or that a stop has overtaken."""
        with self._lock:
            if not self.members.is_driven_by(wish.page):
                raise UserError("this page only watches; let it drive first.")
            if self._stops != wish.stops:
                raise UserError("a stop came while the verb began; start the verb again.")

    def require_bench(self, page: str) -> None:
        """Refuse what changes a bench while another page drives its arm."""
        with self._lock:
            if self.members.driver is not None and not self.members.is_driven_by(page):
                raise UserError("another page drives this arm, and with it the bench; let go there first.")

    def join(self, client: Client, wish: Wish | None = None) -> None:
        """A client begins; a verb with the `wish` for which it runs."""
        with self._lock:
            if wish is not None:
                self.require(wish)
                if self.members.verb is not None:
                    raise UserError("another verb uses the board; wait for its end, or stop it.")
            self.members.add(client)
            if client.verb is None:
                client.outbox.add_answer({"kind": "page", "id": client.id})
                client.outbox.add_answer(self._link)
                client.outbox.add_answer(self._stored_word())
            self.members.tell_driver()

    def leave(self, client: Client) -> None:
        """A client has gone: what runs for it is stopped."""
        with self._lock:
            if client in self.members.clients:
                runs = client is self.members.verb
                self.members.remove(client)
                if runs:
                    self._stop()
                self.release(client)
                self.members.tell_driver()

    def drive(self, client: Client) -> None:
        """Let a page drive, if no other one does."""
        with self._lock:
            self.seen(client)
            if self.members.driver is None and client in self.members.clients:
                self.members.driver = client
                self.members.tell_driver()
            elif self.members.driver is not client:
                self._refuse(client, "another page drives this arm; let go there first.")

    def release(self, client: Client) -> None:
        """Let another page drive; motors that run for this one go off."""
        with self._lock:
            if self.members.driver is client:
                self.members.driver = None
                if self._lease.page is client or self.members.verb is not None:
                    self._stop()
                if self.members.verb is not None:
                    self.members.verb.stop(
                        "The page that drove has let go: start the verb again from a page that drives."
                    )
                self.members.tell_driver()

    def forbid(self, client: Client) -> None:
        """A verb is stopped by itself: it starts no motor from now on."""
        with self._lock:
            client.forbid()

    def stopped(self, where: str, by: Client | None = None) -> None:
        """A person stopped the arm, there: what was asked for before starts no motor any more, and a verb ends.

        All pages but the one by which it was stopped are told: one may be about to start the motors again.
        """
        with self._lock:
            self._stops += 1
            for client in self.members.clients:
                client.stop(f"Stopped {where}: start the verb again when the arm may move.")
            self.members.tell({"kind": "stopped", "sentence": f"The arm was stopped {where}."}, but=by)

    def seen(self, client: Client) -> None:
        """A sign of life."""
        if self._board is not None:
            client.seen_s = self._board.line.clock()

    def receive(self, client: Client, data: bytes) -> None:
        with self._lock:
            self.seen(client)
            for frame in client.decoder.feed(data):
                self._request(client, frame)

    # --- inside -----------------------------------------------------------------------------------------------------

    def _look_for_samples(self, now_s: float) -> None:
        assert self._board is not None
        match self._silence.look(now_s):
            case Step.GIVE_UP:
                raise UserError(f"{self._board.port}: the board fell silent; check its cable and its supply.")
            case Step.TELL:
                self._tell_link(True, self._board.port, f"The board is silent: {_silencers(self._board.port)}?")
            case Step.ASK_AGAIN:
                self._ask_for_samples(1)
            case Step.NOTHING:
                pass

    def _request(self, client: Client, frame: Frame) -> None:
        client.note(frame)
        if frame.type == schema.StopRequest.TYPE:
            self._stop_for(client, frame)
        elif self._board is None:
            self._refuse(client, self._no_board(), frame)
        elif frame.type == schema.TelemetryRequest.TYPE and len(frame.payload) == schema.TelemetryRequest.SIZE:
            client.every = int.from_bytes(frame.payload, "little")
            client.outbox.add_answer(encode_frame(schema.TelemetryReply.TYPE, frame.seq, frame.payload))
        elif problem := self._why_not(client, frame):
            self._refuse(client, problem, frame)
        else:
            self._forward(client, frame)

    def _stop_for(self, client: Client, frame: Frame) -> None:
        """Motors off. What a page stops, stays so; a verb stops only what it started itself."""
        if self._board is not None:
            self._stop(client, frame.seq)
        else:
            self._refuse(client, self._no_board(), frame)
        if client.verb is None:
            where = "from the page that drives" if client is self.members.driver else "from a page that watches"
            self.stopped(where, client)

    def _no_board(self) -> str:
        return self._link["sentence"] or "no board is there yet."

    def _why_not(self, client: Client, frame: Frame) -> str:
        """The reason why a request may not go on, in a sentence."""
        assert self._board is not None
        if self._silence.lasts(self._board.line.clock()):
            return "the board is silent; perhaps it has just restarted."
        if frame.type in _FOR_ALL:
            return ""
        if client.verb is None and self.members.verb is not None:
            return f"`greywhale {self.members.verb.verb}` uses the board; stop it first, or wait for its end."
        if client.verb is None and self.members.driver is not client:
            return "this page only watches; let it drive first."
        if self._lease.is_short and frame.type in _LEASES:
            return _PULSED
        return self._why_no_start(client, frame) if frame.type in STARTS else ""

    def _why_no_start(self, client: Client, frame: Frame) -> str:
        assert self._board is not None
        if problem := client.refuses(frame):
            return problem
        try:
            self._board.may_move()
        except UserError as error:
            return error.message if client.verb is None else ""  # a verb has its own session
        except KeyboardInterrupt:  # a stop was asked for elsewhere; who holds the port tells more
            return "the motors stay off: a stop was asked for in another terminal."
        return ""

    def _refuse(self, client: Client, sentence: str, frame: Frame | None = None) -> None:
        """Send a page a refusal in the place of an answer. A verb gets none, and asks again as after a loss."""
        if client.verb is None:
            which = {} if frame is None else {"seq": frame.seq, "type": frame.type}
            client.outbox.add_answer({"kind": "refused", "sentence": upper_first(sentence), **which})

    def _forward(self, client: Client, frame: Frame) -> None:
        payload = frame.payload
        if client.verb is None and frame.type in _LEASES and len(payload) == schema.EnableRequest.SIZE:
            asked_ms = int.from_bytes(payload, "little")
            is_short = frame.type == schema.LeadRequest.TYPE or 0 < asked_ms < BOARD.lease_ms
            payload = schema.EnableRequest(min(asked_ms, BOARD.lease_ms) if is_short else BOARD.lease_ms).pack()
            if frame.type in STARTS:
                self._lease.begin(client, is_short)
        asked = Asked(frame.type, client, frame.seq)
        if frame.type in STARTS:  # a stop that comes behind it must find it sent
            self._requests.send(asked, payload)
        else:
            self._requests.send_soon(asked, payload)

    def _ask_for_samples(self, every: int) -> None:
        self._requests.send(Asked(schema.TelemetryRequest.TYPE), schema.TelemetryRequest(every).pack())

    def _want_samples(self) -> None:
        assert self._board is not None
        self._silence.begin(self._board.line.clock())
        self._ask_for_samples(1)

    def _stop(self, client: Client | None = None, seq: int = 0) -> None:
        self._lease.end()
        if self._board is not None:
            self._requests.send_stop(client, seq)

    def _pass_answer(self, frame: Frame) -> None:
        asked = self._requests.answered(frame)
        if asked is None or asked.client is None:
            return
        if asked.type in STARTS:
            self._lease.note_answer(asked.client, refused=frame.type == schema.Nack.TYPE)
        asked.client.outbox.add_answer(encode_frame(frame.type, asked.seq, frame.payload))

    def _pass_sample(self, frame: Frame, wire: bytes) -> None:
        assert self._board is not None
        if self._silence.end(self._board.line.clock()):
            self._tell_link(True, self._board.port, "")
        if len(frame.payload) != schema.Sample.SIZE:
            return
        tick = int.from_bytes(frame.payload[:_STATE], "little")
        self.history.add(tick, wire)
        self._lease.note_state(frame.payload[_STATE])
        for client in self.members.clients:
            if client.every and tick % client.every == 0:
                client.outbox.add_sample(wire)

    def _note_restart(self, frame: Frame, wire: bytes) -> None:
        """The board says hello by itself: it has started, its motors are off, and it sends no samples."""
        assert self._board is not None
        self._lease.end()
        self._requests.forget()
        for client in self.members.clients:
            client.outbox.add_answer(wire)
        self._want_samples()
        cause = schema.HelloReply.unpack(frame.payload).reset_cause.description
        self._tell_link(True, self._board.port, f"The board restarted ({cause}), and its motors are off.")

    def _tell_link(self, open: bool, port: str, sentence: str, unflashed: bool = False) -> None:
        self._link = {"kind": "link", "open": open, "port": port, "sentence": sentence, "unflashed": unflashed}
        self.members.tell(self._link)

    def _stored_word(self) -> Message:
        return {"kind": "stored", "crc": self._stored.crc}

    def _tell_stored(self) -> None:
        self.members.tell(self._stored_word())


def _silencers(port: str) -> str:
    """Questions about what keeps a board silent; a simulated one is no quicker than this computer."""
    return "is its supply on" + (", or is this computer too busy to simulate it" if is_bench(port) else "")
