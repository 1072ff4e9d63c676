"""`greywhale info --watch`: angles, errors, voltages and faults as they are, a table on a terminal and lines in a pipe.

The table fits 80 columns and 24 lines. It shows what the potentiometers' converter reads too: while a joint is turned
by hand, its two counts tell how it is wired.
"""

from __future__ import annotations

import textwrap
import time
from collections.abc import Iterable, Iterator
from dataclasses import dataclass
from itertools import takewhile

import click
import numpy as np
import numpy.typing as npt
from rich.console import Console
from rich.live import Live
from rich.text import Text

from greywhale.arm import ArmParameters
from greywhale.base.telling import LINE_COLUMNS
from greywhale.board.device import Device
from greywhale.board.pots import FULL_SCALE, PotReadings, counts_of, pots_there
from greywhale.board.refusal import fault_text
from greywhale.board.stream import stream
from greywhale.cli import torque
from greywhale.observe import LIVE_EVERY_TICKS, Sight, Told, live_torque
from greywhale.protocol import schema
from greywhale.protocol.firmware import ANGLE_LSB, JOINTS
from greywhale.protocol.joints import ALL, Joints
from greywhale.protocol.table import ParameterTable

SAMPLE_EVERY_TICKS = 50  # 20 samples a second
MOST_COMPLAINTS = 2  # shown; the others are counted
_LINE_TICKS = 1000  # between two lines, by the board's
_GROUPS = ("leader", "follower", "error", "voltage")
TORQUES = [f"{group}_{joint}" for group in ("torque", "torque_known_to", "contact") for joint in range(JOINTS)]
HEADING = ",".join(["time_s", "state", "fault", *(f"{group}_{joint}" for group in _GROUPS for joint in range(JOINTS))])


@dataclass(frozen=True)
class Look:
    """One moment: angles in rad, voltages in V, converter counts of leader 0..3 and follower 0..3."""

    port: str
    ticks: int  # since the first look, ms
    sample: schema.Sample
    counts: npt.NDArray[np.int64]
    complaints: tuple[str, ...]  # potentiometers at a rail
    fault: str  # in words with its remedy, "" for none
    lost: int  # samples so far
    joints: Joints = ALL  # in use
    outside: Told | None = None  # with a model; (4,) each

    @property
    def leader(self) -> npt.NDArray[np.float64]:
        return np.array(self.sample.leader) * ANGLE_LSB

    @property
    def follower(self) -> npt.NDArray[np.float64]:
        return np.array(self.sample.follower) * ANGLE_LSB

    @property
    def voltage(self) -> npt.NDArray[np.float64]:
        return np.array(self.sample.voltage) * schema.Sample.LSB["voltage"]


def watch(
    device: Device, table: ParameterTable, seconds: float | None = None, model: ArmParameters | None = None
) -> None:
    """Show the board until Ctrl-C, or for `seconds` of its clock; `table` runs on it. Telemetry is off afterwards."""
    console = Console()
    found = takewhile(lambda look: seconds is None or look.ticks <= 1000 * seconds, looks(device, table, model))
    try:
        if console.is_terminal:
            with Live(console=console, auto_refresh=False, transient=True) as live:
                for look in _paced(found):
                    live.update(Text(as_table(look)), refresh=True)
        else:
            click.echo(HEADING if model is None else ",".join([HEADING, *TORQUES]))
            for look in _spaced(found):
                click.echo(as_line(look))
    finally:
        device.telemetry(0)


def looks(device: Device, table: ParameterTable, model: ArmParameters | None = None) -> Iterator[Look]:
    """Yield a look at the board's newest sample, again and again, without end."""
    fault, fault_words, lost, due = schema.Fault.NONE, "", 0, 0
    every = SAMPLE_EVERY_TICKS if model is None else LIVE_EVERY_TICKS  # of which as many are shown
    outside = None if model is None else live_torque(model, table["filter_shift"])
    for one in stream(device, every):
        lost += one.lost
        seen = None if outside is None else Told(*(rows[0] for rows in outside.feed_samples([one.sample])))
        if one.elapsed < due and one.sample.fault is fault:
            continue
        due = one.elapsed + SAMPLE_EVERY_TICKS - every // 2
        if one.sample.fault is not fault:
            fault = one.sample.fault
            status = device.status()
            fault_words = "" if status.fault is schema.Fault.NONE else fault_text(status)
        counts = np.clip(np.rint(counts_of([one.sample], table)), 0, FULL_SCALE).astype(np.int64)
        complaints = tuple(PotReadings(counts, table["rail_counts"], pots_there(table)).complaints())
        yield Look(
            device.port, one.elapsed, one.sample, counts[0], complaints, fault_words, lost, table.joints_in_use, seen
        )


def as_table(look: Look) -> str:
    lost = f", {look.lost} samples lost" if look.lost else ""
    board = f"{look.port}, state {look.sample.state.key}, {look.sample.tick / 1000:.1f} s since its start{lost}"
    outside, unit = ("", "") if look.outside is None else ("outside", "N m")
    lines = [
        *textwrap.wrap(board, LINE_COLUMNS),
        "",
        f"{'':8}{'leader':>17}{'follower':>17}{'error':>10}{'voltage':>10}{outside:>18}".rstrip(),
        f"{'':8}{'rad':>9}{'counts':>8}{'rad':>9}{'counts':>8}{'rad':>10}{'V':>10}{unit:>18}".rstrip(),
    ]
    for joint in range(JOINTS):
        if joint not in look.joints:
            lines.append(f"joint {joint}{'not in use':>18}")
            continue
        leader, follower = look.leader[joint], look.follower[joint]
        lines.append(
            f"joint {joint} {leader:>+9.3f}{look.counts[joint]:>8}{follower:>+9.3f}{look.counts[JOINTS + joint]:>8}"
            f"{leader - follower:>+10.3f}{look.voltage[joint]:>+10.2f}"
            f"{_outside(look, joint):>18}".rstrip()
        )
    sentences = [f"Fault: {look.fault}" if look.fault else "No fault.", *look.complaints[:MOST_COMPLAINTS]]
    if len(look.complaints) > MOST_COMPLAINTS:
        sentences.append(f"{len(look.complaints) - MOST_COMPLAINTS} more potentiometers are at a rail.")
    sentences.append("Ctrl-C ends this.")
    return "\n".join([*lines, "", *(line for sentence in sentences for line in textwrap.wrap(sentence, LINE_COLUMNS))])


def _outside(look: Look, joint: int) -> str:
    if look.outside is None:
        return ""
    seen = look.outside
    return torque.cell(seen.torque[joint], seen.half_width[joint], seen.sight[joint], bool(seen.contact[joint]))


def as_line(look: Look) -> str:
    """The line of a look under HEADING; a torque that cannot be told is empty."""
    angles = [*look.leader, *look.follower, *(look.leader - look.follower)]
    numbers = [*(f"{angle:.6f}" for angle in angles), *(f"{volts:.3f}" for volts in look.voltage)]
    if (seen := look.outside) is not None:
        for values in (seen.torque, seen.half_width):
            told = zip(values, seen.sight, strict=True)
            numbers += [f"{value:.3f}" if sight == Sight.TOLD else "" for value, sight in told]
        numbers += [f"{int(one)}" for one in seen.contact]
    return ",".join([f"{look.ticks / 1000:.3f}", look.sample.state.key, look.sample.fault.key, *numbers])


def _paced(found: Iterable[Look]) -> Iterator[Look]:
    """One look at most every so often by this machine's clock: a terminal takes its time."""
    next_s = 0.0
    for look in found:
        now = time.monotonic()
        if now >= next_s:
            next_s = now + 0.1
            yield look


def _spaced(found: Iterable[Look]) -> Iterator[Look]:
    """One every so often by the board's clock, and whenever its state or its fault changes."""
    ticks, last = 0, None
    for look in found:
        now = (look.sample.state, look.sample.fault)
        if look.ticks >= ticks or now != last:
            last = now
            ticks = look.ticks - look.ticks % _LINE_TICKS + _LINE_TICKS
            yield look
