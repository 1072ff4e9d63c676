"""A greywhale board on a serial port: greeting, requests with retries, motors that never stay on by accident.

An Arduino resets when its port is opened. Its bootloader then listens first, for up to two seconds. The Mega's
bootloader stays for several seconds more once it has seen any byte. So this side keeps quiet until it has heard the
firmware (which sends one hello by itself when it starts) or until the bootloader must have ended.
"""

from __future__ import annotations

import contextlib
import logging
import signal
from collections import deque
from collections.abc import Callable, Iterator
from contextlib import AbstractContextManager
from types import TracebackType
from typing import Any, Self

from greywhale.base.errors import UserError
from greywhale.base.interrupts import hold_back
from greywhale.board.greeting import NoAnswerError, hello_in, silence, version
from greywhale.board.limits import PATIENCE
from greywhale.board.refusal import RefusedError
from greywhale.board.session import Session
from greywhale.protocol import schema
from greywhale.protocol.declared import Reply_co, Request
from greywhale.protocol.frames import Frame, FrameDecoder, encode_frame
from greywhale.protocol.lines import open_line
from greywhale.protocol.transport import Line, PortDisturbedError, PortLostError, disturbance

STOP_ATTEMPTS = round(PATIENCE.request_attempts * PATIENCE.reply_wait_s / PATIENCE.stop_repeat_s)

logger = logging.getLogger(__name__)

# Requests count 1..255; the hello that a starting board sends by itself has this sequence number.
_UNASKED_SEQ = 0


class RestartedError(UserError):
    """The board restarted in the middle; its motors are off, and it runs its stored set. `cause` is in words."""

    def __init__(self, port: str, cause: str) -> None:
        super().__init__(
            f"{port}: the board restarted in the middle ({cause}) and its motors are off; check its supply and try "
            "again."
        )
        self.cause = cause


class Device:
    """An open and greeted board. Leaving the context, for whatever reason, stops the motors if they may be on."""

    def __init__(
        self,
        port: str,
        quiet_s: float = PATIENCE.quiet_s,
        patience_s: float = PATIENCE.patience_s,
        *,
        restart: bool = True,
    ) -> None:
        """Open the port and greet the board, which restarts; without `restart` only where the system cannot help it."""
        self.port = port
        self.lease_ms = 0
        self._decoder = FrameDecoder()
        self._replies: deque[Frame] = deque(maxlen=32)
        self._samples: list[schema.Sample] = []
        self._lead_progress: schema.LeadPointReply | None = None
        self._lead_refused: schema.Nack | None = None
        self._sequence = _UNASKED_SEQ
        self._heard_bytes = False
        self._started: bytes | None = None
        self._greeted = False
        self._motors_may_run = False
        self._broke_off = False  # by Ctrl-C, with the motors on
        with contextlib.ExitStack() as held:
            self._session = held.enter_context(Session.of(port))
            held.callback(self._session.detach)
            self._transport: Line = open_line(port, restart)
            held.callback(lambda: self._transport.close())
            self._session.attach(self._send_stop, self._send_clutch)
            try:
                self.hello: schema.HelloReply = self._greet(quiet_s if self.restarted else 0.0, patience_s)
            except NoAnswerError as unheard:
                if self.restarted:
                    raise
                self._restart(unheard)
                self.hello = self._greet(quiet_s, patience_s)
            self._held = held.pop_all()
        logger.info(
            "%s: %s, firmware %s, parameters 0x%04x, %s",
            port, self.hello.board.key, self.firmware_version, self.hello.param_crc,
            "restarted" if self.restarted else "not restarted",
        )  # fmt: skip

    def __enter__(self) -> Self:
        return self

    def __exit__(
        self, kind: type[BaseException] | None, error: BaseException | None, trace: TracebackType | None
    ) -> None:
        self._session.explain(error)
        broke_off = self._broke_off or (self._motors_may_run and isinstance(error, KeyboardInterrupt))
        try:
            self.close()
        except UserError as problem:
            if error is None:
                raise
            error.add_note(problem.message)
        else:
            if error is not None and broke_off:
                error.add_note("The motors are off.")

    def close(self) -> None:
        """Stop the motors if they may run, then close the port."""
        try:
            if self._motors_may_run or self._session.waiting:
                self.stop()
        finally:
            self._held.close()

    @property
    def restarted(self) -> bool:
        """True if opening the port restarted the board (False: it runs on from the session before)."""
        return self._transport.restarted

    @property
    def firmware_version(self) -> str:
        return version(self.hello)

    def clock(self) -> float:
        """The time (s) that waiting for the board is measured in."""
        return self._transport.clock()

    def wait(self, seconds: float) -> None:
        self._transport.wait(seconds)

    def ask(self, request: Request[Reply_co]) -> Reply_co:
        """Send a request until it is answered, and return the answer; a refusal is a UserError with its remedy."""
        self._session.check()
        try:
            payload = self._exchange(request.TYPE, request.NAME, request.pack(), PATIENCE.request_attempts)
        except NoAnswerError as unheard:
            raise disturbance(self._transport) or unheard from None
        try:
            return request.reply(payload)
        except UserError as error:
            raise UserError(f"{self.port}: {error.message}") from None

    def greet(self) -> schema.HelloReply:
        """Say hello again: `hello` then holds the CRC of the set that runs now."""
        self.hello = self.ask(schema.HelloRequest())
        return self.hello

    def status(self) -> schema.StatusReply:
        return self.ask(schema.StatusRequest())

    def clutch(self, action: schema.ClutchAction) -> schema.Clutch:
        """Engage or disengage the leader arm, or reset the clutch; how it is from now on."""
        return self.ask(schema.ClutchRequest(action)).clutch

    def telemetry(self, every: int) -> None:
        """Ask for a sample every so many ticks; 0 turns them off. Earlier samples are forgotten."""
        echoed = self.ask(schema.TelemetryRequest(every)).every
        if echoed != every:
            raise UserError(
                f"{self.port}: the board set telemetry to every {echoed} ticks instead of {every}; try again."
            )
        self._samples.clear()

    def enable(self, lease_ms: int) -> None:
        """Start the motors. They go off by themselves when the lease is not renewed in time (0: only on stop)."""
        self._expect_motion(lease_ms)
        logger.info("%s: motors on, lease %d ms", self.port, lease_ms)
        self.ask(schema.EnableRequest(lease_ms))

    def lead(self, lease_ms: int) -> schema.LeadReply:
        """Start the motors with this host in the leader's place; `lead_point` sends the points of the reference."""
        self._expect_motion(lease_ms)
        self._lead_progress = self._lead_refused = None
        logger.info("%s: motors on, led by this host, lease %d ms", self.port, lease_ms)
        return self.ask(schema.LeadRequest(lease_ms))

    def lead_point(self, number: int, step: tuple[int, int, int, int]) -> None:
        """Send a point of the reference without waiting for the answer; `lead_progress` returns that later."""
        self._session.refuse_motion()
        self._send(schema.LeadPointRequest(number, step), self._next_sequence())

    def lead_progress(self) -> schema.LeadPointReply | None:
        """The last answer to a point, None before the first. Raises where the board refused it."""
        if self._lead_refused is not None:
            raise RefusedError(self.port, schema.LeadPointRequest.NAME, self._lead_refused)
        return self._lead_progress

    @contextlib.contextmanager
    def enabled(self, lease_ms: int) -> Iterator[None]:
        """Motors on inside the context, off afterwards, also when an error or Ctrl-C ends it."""
        with self._motors_on(lambda: self.enable(lease_ms)):
            yield

    @contextlib.contextmanager
    def leading(self, lease_ms: int) -> Iterator[schema.LeadReply]:
        """Enable the motors with this host in the leader's place."""
        begun: list[schema.LeadReply] = []
        with self._motors_on(lambda: begun.append(self.lead(lease_ms))):
            yield begun[0]

    @contextlib.contextmanager
    def _motors_on(self, start: Callable[[], None]) -> Iterator[None]:
        try:
            start()
            yield
        except BaseException as error:
            self._session.explain(error)
            try:
                self.stop()
                self._broke_off = isinstance(error, KeyboardInterrupt)
            except UserError as problem:
                gone = isinstance(error, PortLostError | PortDisturbedError)  # which needs not be said twice
                error.add_note(self._unconfirmed_stop() if gone else problem.message)
            raise
        self.stop()

    def renew(self) -> None:
        """Renew the lease without waiting for the answer; the next renewal replaces a lost one."""
        self._send(schema.RenewRequest(self.lease_ms), self._next_sequence())

    def lend(self) -> tuple[Line, Session]:
        """Line and session, for who sends and reads frames there from now on; closing the device stops the motors."""
        self._motors_may_run = True
        return self._transport, self._session

    def stop(self) -> None:
        """Turn the motors off, confirmed by the board. A further Ctrl-C does not hold the request back."""
        with hold_ctrl_c():
            try:
                message = stop_message(self._next_sequence())
                answer = self._repeat(
                    message, schema.StopRequest.TYPE, schema.StopRequest.NAME, STOP_ATTEMPTS, PATIENCE.stop_repeat_s,
                    PortDisturbedError,  # that somebody else reads does not keep the stop from the board
                )  # fmt: skip
                state = schema.StopReply.unpack(answer).state.key
                logger.info("%s: motors off, state %s", self.port, state)
                self._session.confirm({"state": state})
            except UserError as error:
                # After one failed attempt, closing need not try again. After a restart the motors are off anyway.
                self._motors_may_run = False
                if self._started is None:
                    problem = UserError(f"{error.message} {self._unconfirmed_stop()}")
                    self._session.confirm({"problem": problem.message})
                    raise problem from None
        self._motors_may_run = False

    def samples(self) -> list[schema.Sample]:
        """The samples received since the last call; waits a moment when there are none."""
        self._session.check()
        if not self._samples:
            self._receive()
            self._check_restart()
        taken = self._samples
        self._samples = []
        return taken

    def _exchange(self, kind: int, name: str, payload: bytes, attempts: int) -> bytes:
        """The payload of the answer to a request."""
        message = encode_frame(kind, self._next_sequence(), payload)
        return self._repeat(message, kind, name, attempts, PATIENCE.reply_wait_s)

    def _repeat(
        self, message: bytes, kind: int, name: str, attempts: int, wait_s: float, *ignored: type[UserError]
    ) -> bytes:
        """Send a message again and again until its request is answered, whatever `ignored` failures come between."""
        for attempt in range(1, attempts + 1):
            logger.debug("%s: %s, attempt %d of %d: %s", self.port, name, attempt, attempts, message.hex())
            looked = self._transport.clock()
            self._transport.write(message)
            deadline = looked + wait_s
            # A computer that stood still for long looks once more: the answer may have waited all the time. One look
            # alone may take as long as a stop waits.
            while (now := self._transport.clock()) < deadline or now > looked + PATIENCE.reply_wait_s:
                looked = now
                with contextlib.suppress(*ignored):
                    self._receive()
                self._check_restart()
                for frame in self._answers():
                    logger.debug("%s: %s answered: %02x %s", self.port, name, frame.type, frame.payload.hex())
                    if frame.type == kind | schema.REPLY_BIT:
                        return frame.payload
                    if frame.type == schema.Nack.TYPE:
                        raise RefusedError(self.port, name, schema.Nack.unpack(frame.payload))
        raise NoAnswerError(
            f"{self.port}: the board did not answer {name}, sent {attempts} times in {attempts * wait_s:.1f} s; "
            "check the cable, reset the board and try again."
        )

    def _send_stop(self) -> None:
        """Send a stop from any thread. Nobody waits for the answer, whose number no request has."""
        self._transport.write(stop_message(_UNASKED_SEQ))

    def _send_clutch(self, action: str) -> None:
        """Ask the clutch to engage or disengage."""
        self._send(schema.ClutchRequest(schema.ClutchAction[action.upper()]), _UNASKED_SEQ)

    def _send(self, request: Request[Any], sequence: int) -> None:
        self._transport.write(encode_frame(request.TYPE, sequence, request.pack()))

    def _expect_motion(self, lease_ms: int) -> None:
        self._session.refuse_motion()
        self._motors_may_run = True
        self.lease_ms = lease_ms

    def _next_sequence(self) -> int:
        self._sequence = self._sequence % 255 + 1
        return self._sequence

    def _receive(self) -> None:
        data = self._transport.read()
        if not data:
            return
        self._heard_bytes = True
        for frame in self._decoder.feed(data):
            if frame.type == schema.Sample.TYPE:
                self._samples.append(schema.Sample.unpack(frame.payload))
            elif frame.type == schema.HelloReply.TYPE and frame.seq == _UNASKED_SEQ:
                self._started = frame.payload
            elif frame.type == schema.LeadPointReply.TYPE:
                self._lead_progress = schema.LeadPointReply.unpack(frame.payload)
            elif frame.type == schema.Nack.TYPE and frame.payload[:1] == bytes([schema.LeadPointRequest.TYPE]):
                self._lead_refused = schema.Nack.unpack(frame.payload)
            elif frame.type & schema.REPLY_BIT:
                self._replies.append(frame)

    def _answers(self) -> Iterator[Frame]:
        """Take answers to the current request; late answers to earlier requests are dropped."""
        while self._replies:
            frame = self._replies.popleft()
            if frame.seq == self._sequence:
                yield frame

    def _check_restart(self) -> None:
        if self._started is not None and self._greeted:
            self._motors_may_run = False
            cause = schema.HelloReply.unpack(self._started).reset_cause
            raise RestartedError(self.port, cause.description)

    def _unconfirmed_stop(self) -> str:
        if self.lease_ms:
            return f"The stop is not confirmed; the board stops by itself within {self.lease_ms} ms."
        return "The stop is not confirmed: switch the motors' supply off."

    def _restart(self, unheard: NoAnswerError) -> None:
        """Open the port anew: another program may have left the board in its bootloader, which only that ends."""
        self._transport.close()
        self._transport = open_line(self.port)
        if not self.restarted:  # a lent line
            raise unheard

    def _greet(self, quiet_s: float, patience_s: float) -> schema.HelloReply:
        clock = self._transport.clock
        opened = clock()
        while self._started is None and not self._samples and clock() < opened + quiet_s:
            self._receive()
        while True:
            try:
                payload = self._exchange(schema.HelloRequest.TYPE, schema.HelloRequest.NAME, b"", attempts=1)
                break
            except NoAnswerError:
                if clock() >= opened + patience_s:
                    raise disturbance(self._transport) or silence(self.port, patience_s, self._heard_bytes) from None
        self._started = None
        self._greeted = True
        return hello_in(payload, self.port)


def stop_message(sequence: int) -> bytes:
    """A stop as it goes over the line: twice, each after a 00 that ends whatever the line has left in the receiver."""
    return 2 * (b"\0" + encode_frame(schema.StopRequest.TYPE, sequence, schema.StopRequest().pack()))


def hold_ctrl_c() -> AbstractContextManager[None]:
    """Hold Ctrl-C back for what takes a second at most, such as a stop."""
    return hold_back(signal.SIGINT)
