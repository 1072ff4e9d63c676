"""The board's samples as they come. The board's own ticks count the gaps, and the lease of the motors is kept alive.

The lease is renewed by the time in the samples, not by this machine's clock: a simulated board may live many times
faster than real time, but never runs ahead of samples that nobody has read. It is renewed once for all samples that
came together: after a pause there are hundreds.
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass

from greywhale.base.errors import UserError
from greywhale.board.device import Device
from greywhale.board.limits import PATIENCE, RECORDING
from greywhale.board.refusal import fault_text, lower_first
from greywhale.protocol import schema

# Faults of how an arm moves, which its controllers may cause. Every other is one of a part of the arm or of the board.
OF_THE_MOTION = (
    schema.Fault.TRACKING,
    schema.Fault.UNREST,
    schema.Fault.SPEED,
    schema.Fault.RUNAWAY,
    schema.Fault.STALLED,
)

_TICK_COUNTS = 1 << 32  # after so many the board counts its ticks from 0 again


class LeaseLostError(UserError):
    """The board went on and turned the motors off, because this computer was late; the same may be tried again."""

    def __init__(self, port: str, lease_ms: int) -> None:
        super().__init__(
            f"{port}: the board went on, but this computer did not renew the lease of {lease_ms} ms in time, so the "
            "motors went off: the computer was stopped, asleep or too busy; close other programs and try again."
        )


@dataclass(frozen=True, slots=True)
class Received:
    """A sample, its time since the first one in ms ticks of the board, and how many were lost just before it."""

    sample: schema.Sample
    elapsed: int
    lost: int


def stream(device: Device, every: int) -> Iterator[Received]:
    """Turn telemetry on, then yield samples for as long as the caller takes them; the caller turns telemetry off."""
    device.telemetry(every)
    return _samples(device, every)


def _samples(device: Device, every: int) -> Iterator[Received]:
    silence_s = max(PATIENCE.silence_s, 5 * every / 1000)
    last: int | None = None
    elapsed = 0
    renewed: int | None = None
    heard = looked = device.clock()
    paused = False
    while True:
        samples = device.samples()
        now = device.clock()
        if now > looked + PATIENCE.pause_s:
            heard += now - looked  # this host stood still, not the board
            paused = True
        looked = now
        if not samples and now > heard + silence_s:
            raise _silence(device, last, silence_s, paused)
        if samples:
            newest = samples[-1].tick
            renewed = samples[0].tick if renewed is None else renewed
            if device.lease_ms and (newest - renewed) % _TICK_COUNTS >= device.lease_ms // PATIENCE.renewals_per_lease:
                device.renew()
                renewed = newest
        for sample in samples:
            step = every if last is None else (sample.tick - last) % _TICK_COUNTS
            if step == 0:
                continue  # the same sample again says nothing new
            heard = now
            if step > _TICK_COUNTS // 2:
                raise UserError(
                    f"{device.port}: the board's clock went backwards: it restarted in the middle; try again."
                )
            if step > 1000 * RECORDING.longest_s:  # no board that was heard all the time is silent for so long
                raise UserError(
                    f"{device.port}: the board's clock jumped by {step / 1000:.3f} s between two samples, so the times "
                    "of what follows are not known; reset the board and try again."
                )
            lost = max(0, round(step / every) - 1) if last is not None else 0
            elapsed += step if last is not None else 0
            last = sample.tick
            yield Received(sample, elapsed, lost)


def _silence(device: Device, last: int | None, silence_s: float, paused: bool) -> UserError:
    status = device.status()
    if last is not None and status.tick < last:
        return UserError(
            f"{device.port}: the board restarted in the middle and its motors are off; check its supply and try again."
        )
    # Where this host looked all the time, the lease ended because no sample came to renew it by.
    if paused and device.lease_ms and status.stop_reason is schema.StopReason.LEASE:
        return why_stopped(device)
    return UserError(
        f"{device.port}: the board answers but sent no sample for {silence_s:g} s (state {status.state.key}); "
        "reset it and try again."
    )


def why_stopped(device: Device) -> UserError:
    """The board's reason in words, after the motors went off by themselves."""
    status = device.status()
    if status.state is schema.State.FAULT or status.stop_reason is schema.StopReason.FAULT:
        return UserError(f"{device.port}: the board stopped the motors: {fault_text(status)}")
    if status.stop_reason is schema.StopReason.LEASE:
        return LeaseLostError(device.port, device.lease_ms)
    return UserError(
        f"{device.port}: the motors went off in the middle: {lower_first(status.stop_reason.description)}; try again."
    )
