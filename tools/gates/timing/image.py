"""The bounds of a firmware image: its tick, each of its interrupts, and the tick with the interrupts that may come."""

from __future__ import annotations

import math
import re
from collections.abc import Mapping
from dataclasses import dataclass, replace
from functools import cached_property
from pathlib import Path

from elftools.elf.elffile import ELFFile

from tools import BUILT_BY_SYSTEM, BUILT_FIRMWARE
from tools.gates.timing import facts
from tools.gates.timing.bound import Timing
from tools.gates.timing.cycles import MEGA, NANO, Chip
from tools.gates.timing.listing import ImageError, Program, read_program

TICK = "firmware_tick"
PERIOD = 16_000  # cycles from one tick to the next
BYTE = 160  # cycles that a byte takes on the line at 1 Mbaud
CONVERSION = 416
CONVERSIONS = 32  # in a tick
FIRST_CONVERSION = 33 * 64 + CONVERSION  # its end, in cycles after the tick's interrupt: hal's chain_start, and itself
RING = 127  # bytes: no more are received while the main loop does not get to the ring
HELD = 2  # received bytes in the chip while a third comes in, so three interrupts may be due at once
SENT = 2  # interrupts of sent bytes between the tick's interrupt and hal::tick_begin(), which ends them


@dataclass(frozen=True)
class Target:
    """A board's image and which vector does what."""

    chip: Chip
    environment: str
    vectors: Mapping[str, int]
    built: Path = BUILT_FIRMWARE

    @property
    def elf(self) -> Path:
        return self.built / self.environment / "firmware.elf"

    @cached_property
    def compiler(self) -> str:
        """The version of the GCC that made the image."""
        with self.elf.open("rb") as stream:
            section = ELFFile(stream).get_section_by_name(".comment")
            found = re.search(rb"GCC: \(.*?\) ([0-9.]+)", section.data()) if section else None
        return found[1].decode() if found else "unknown"

    @property
    def title(self) -> str:
        return f"{self.chip.name}, GCC {self.compiler}"

    def is_described(self) -> bool:
        """True if facts.toml is about the compiler that made the image: another one may make other loops."""
        return self.compiler in facts.load().compilers


def _vectors(tick: int, chain: int, received: int, sent: int, conversion: int) -> dict[str, int]:
    return {
        "tick's interrupt": tick,
        "start of the chain": chain,
        "conversion done": conversion,
        "byte received": received,
        "byte sent": sent,
    }


TARGETS = (
    Target(MEGA, "megaatmega2560", _vectors(21, 22, 25, 26, 29)),
    Target(NANO, "nanoatmega328", _vectors(14, 15, 18, 19, 21)),
)


def built() -> list[Target]:
    """The boards' images, and those by the system's compiler where checks are set up."""
    second = [replace(target, built=BUILT_BY_SYSTEM) for target in TARGETS]
    return [*TARGETS, *(target for target in second if target.elf.exists())]


@dataclass(frozen=True)
class Times:
    """Bounds in cycles. An interrupt counts from its acceptance to the end of RETI, with `waking` in front of it."""

    tick: int
    interrupts: dict[str, int]
    waking: int

    def response(self, receiving: bool) -> int | None:
        """The tick with all interrupts that may come until its end; None if that is not before the next tick.

        Every kind comes as often as its least distance allows, conversions not before the chain has begun. The tick
        begins with a pause of sending. The tick's own interrupt may end a sleep; during a tick there is none.
        """
        during = {kind: cycles - self.waking for kind, cycles in self.interrupts.items()}
        once = self.tick + self.interrupts["tick's interrupt"] + during["start of the chain"]
        once += SENT * during["byte sent"]
        end = once
        while end <= PERIOD:
            conversions = math.ceil(max(0, end - FIRST_CONVERSION) / CONVERSION)
            longer = once + min(CONVERSIONS, conversions) * during["conversion done"]
            longer += receiving * min(RING, math.ceil(end / BYTE) + HELD) * during["byte received"]
            if longer == end:
                return end
            end = longer
        return None


def _handlers(program: Program, target: Target) -> dict[str, int]:
    """Role -> address; a handler that has no role is refused."""
    found, known = set(program.vectors), set(target.vectors.values())
    if found != known:
        more, less = sorted(found - known), sorted(known - found)
        raise ImageError(f"the image has the interrupts {more} without a role and lacks {less}.")
    return {role: program.vectors[number] for role, number in target.vectors.items()}


def times(target: Target) -> Times:
    """The bounds of an image; raises ImageError for what has none."""
    program = read_program(target.elf)
    timing = Timing(program, target.chip, facts.load())
    waking, vector_table_jump = target.chip.interrupt_entry, 3
    entry = waking + target.chip.interrupt_entry + vector_table_jump
    interrupts = {role: entry + timing.of(address) for role, address in _handlers(program, target).items()}
    return Times(timing.of(program.entry(TICK)), interrupts, waking)
