"""The link under load: a sample each tick, and requests one after the other, whose answers must be what was stored."""

from __future__ import annotations

import time
from collections.abc import Callable
from dataclasses import dataclass

from greywhale.board.device import Device
from greywhale.board.doctor.finding import Finding, Verdict
from greywhale.board.stream import stream
from greywhale.protocol import schema
from greywhale.protocol.table import ParameterTable

_COUNTERS = ("frames_bad", "rx_overruns", "telemetry_dropped")


@dataclass(frozen=True)
class Traffic:
    """Counts of frames sent and of errors. `lost` are samples; `slowest_s` is the longest wait for an answer."""

    samples: int
    lost: int
    requests: int
    wrong: int  # answers that were not what the board holds
    slowest_s: float
    frames_bad: int  # that the board refused
    rx_overruns: int
    telemetry_dropped: int


def exchange(device: Device, table: ParameterTable, seconds: float, report: Callable[[float], None]) -> Traffic:
    """Load the link for so many seconds of the board's time; `table` runs there. Telemetry is off afterwards."""
    before = device.status()
    held = list(table.by_name().items())
    samples = lost = requests = wrong = 0
    slowest, ticks = 0.0, round(seconds * 1000)
    try:
        for one in stream(device, 1):
            samples, lost = samples + 1, lost + one.lost
            if one.elapsed >= ticks:
                break
            if samples % 8 == 0:
                name, stored = held[requests % len(held)]
                index = schema.PARAMETER_BY_NAME[name].index
                asked = time.monotonic()
                answer = device.ask(schema.ParamGetRequest(index))
                slowest = max(slowest, time.monotonic() - asked)
                requests += 1
                wrong += (answer.index, answer.value) != (index, stored)
                report(min(1.0, one.elapsed / ticks))
    finally:
        device.telemetry(0)
    after = device.status()
    grown = {name: (getattr(after, name) - getattr(before, name)) % 65536 for name in _COUNTERS}
    return Traffic(samples, lost, requests, wrong, slowest, **grown)


def examine_traffic(traffic: Traffic, repeat_s: float) -> Finding:
    """One finding; an answer that took longer than `repeat_s` was asked for again."""
    checked = f"{traffic.samples:,} samples and {traffic.requests:,} answers"
    problems = [
        (traffic.wrong, "answers were wrong"),
        (traffic.lost, "samples were lost"),
        (traffic.frames_bad, "frames reached the board damaged"),
        (traffic.rx_overruns, "times the board lost bytes"),
    ]
    found = [f"{count} {what}" for count, what in problems if count]
    late = f"an answer took {traffic.slowest_s:.2f} s" if traffic.slowest_s > repeat_s else ""
    if not found and not late:
        return Finding("link", Verdict.GOOD, f"{checked} at 1 Mbaud, none lost, none damaged.")
    if not found:  # nothing is lost by that: requests are repeated
        return Finding("link", Verdict.NOTE, f"{checked}, none lost or damaged, but {late}.", "Close other programs.")
    found += [late] if late else []
    return Finding(
        "link",
        Verdict.BAD,
        f"Of {checked}: {', '.join(found)}.",
        "Use a short USB cable without a hub, keep motor wires away from it, and close other programs.",
    )
