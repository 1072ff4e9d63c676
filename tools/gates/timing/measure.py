"""The dearest tick and interrupts that a search finds on the simulated boards: the other end of what the bounds say.

The search draws controllers and readings where the code has most to do: sets that bend there, pots at their rails,
joints far apart, errors that saturate, with telemetry and a busy line.
"""

from __future__ import annotations

import numpy as np

from greywhale.protocol import frames, schema
from greywhale.protocol.declared import Reply_co, Request
from greywhale_sim.board_with_image import BoardWithImage
from greywhale_sim.wiring import BOARDS
from tools.gates.timing.image import PERIOD, TICK, Target
from tools.gates.timing.listing import read_program
from tools.support.fuzzy_search import Random

SETS, TICKS_PER_SET = 300, 24
FORGIVEN_MS = 40  # after two ticks at a rail
BEST = 6  # sets near which most others are drawn
RAIL_MV = 5000.0
STACK_POINTER = 0x5D  # data address of SPL
WIDE, STEEP = 25_723, 16_384  # the largest limit of a joint and the steepest pot that the table allows


class Session(BoardWithImage):
    """The real image, with motors on and readings that disturb it."""

    def __init__(self, target: Target, seed: int) -> None:
        name = next(name for name, wiring in BOARDS.items() if wiring.environment == target.environment)
        super().__init__(name, seed, target.built)
        self.random = np.random.default_rng(seed)
        self.tick = read_program(target.elf).entry(TICK)
        self.return_address = target.chip.return_address

    def ask(self, request: Request[Reply_co]) -> Reply_co:
        """A zero first: noise may have come before."""
        self.board.uart_send(b"\0")
        return super().ask(request)

    def rest(self) -> None:
        self.board.set_millivolts(self.millivolts)

    def disturb(self) -> None:
        self.board.set_millivolts(_readings(self.random))

    def run_set(self, values: dict[str, int]) -> None:
        """Runs the defaults but for these values, motors on."""
        self.ask(schema.StopRequest())
        self.rest()
        self.wait(40)
        self.ask(schema.ClearFaultRequest())
        self.apply(values)
        self.wait(30)
        self.ask(schema.EnableRequest(0))
        self.wait(5)

    def end_of_tick(self) -> int:
        """Runs through the next tick's function; the cycle at which it has returned."""
        return self.end_of_call(self.tick)

    def end_of_call(self, address: int) -> int:
        """Runs through the next call of the function there; the cycle at which it has returned."""
        self.run_to(address)
        level = int.from_bytes(self.board.peek(STACK_POINTER, 2), "little")
        back = self.board.peek(level + 1, self.return_address)
        return self.run_to(2 * int.from_bytes(back, "big"))

    def cycles_of_tick_alone(self) -> int:
        """Cycles of the next tick alone, from its first instruction to the end of its return."""
        start, interrupts = self.run_to(self.tick), self.interrupt_cycles()
        return round(self.end_of_tick() - start - (self.interrupt_cycles() - interrupts))


def _readings(random: np.random.Generator) -> np.ndarray:
    """Eight voltages: spread a little or a lot, some of them at a rail; often alike for all joints."""
    millivolts = RAIL_MV / 2 + random.uniform(-1, 1, 8) * 10.0 ** random.uniform(0, 3.4)
    rails = random.random(8) < random.choice([0.0, 0.3, 1.0])
    millivolts = np.where(rails, random.choice([0.0, RAIL_MV], 8), millivolts).clip(0, RAIL_MV)
    return np.repeat(millivolts[[0, 4]], 4) if random.random() < 0.7 else millivolts


def parameters(draw: Random) -> dict[str, int]:
    """Draws a set whose joints bend anywhere and may be far apart, and which raises no fault for that.

    Joints that are alike are dear in the same tick.
    """
    random = draw.random
    values = {
        "supply_mv": int(random.choice([3000, 15000, 30000])),
        "filter_shift": int(random.choice([0, 2, 3, 4])),
        "soft_start_ms": 100,
        "tracking_limit": int(random.choice([0, 1, 3000])),
        "tracking_ms": 60_000,
        "unrest_amplitude": 0,
        "speed_limit": 0,
        "runaway_limit": 0,
        "stall_volts": 0,
    }
    wide, alike = random.random() < 0.5, random.random() < 0.7
    settings = vars(draw.settings(1))
    for joint in range(4):
        values |= {f"joint{joint}.{key}": value for key, value in settings.items()}
        if wide:
            values |= {f"joint{joint}.limit_min": -WIDE, f"joint{joint}.limit_max": WIDE}
            values |= {f"leader{joint}.scale": STEEP, f"follower{joint}.scale": STEEP}
        if not alike:
            settings = vars(draw.settings(1))
    return values


def _near(draw: Random, values: dict[str, int]) -> dict[str, int]:
    """A set near another: some of its parameters drawn anew, for all joints together."""
    drawn = parameters(draw)
    names = sorted({key.partition(".")[2] or key for key in values})
    again = {name for name in names if draw.random.random() < 0.25}
    return values | {key: value for key, value in drawn.items() if (key.partition(".")[2] or key) in again}


def worst(target: Target, sets: int = SETS, seed: int = 5) -> dict[str, int]:
    """The dearest tick alone, and the dearest run of every interrupt, in cycles."""
    session, draw = Session(target, seed), Random(seed)
    best: list[tuple[int, dict[str, int]]] = []
    for number in range(sets):
        values = _near(draw, best[number % len(best)][1]) if number % 4 and best else parameters(draw)
        session.run_set(values)
        session.ask(schema.TelemetryRequest(1))
        dearest = 0
        for _ in range(TICKS_PER_SET):
            session.disturb()
            if session.random.random() < 0.3:
                session.board.uart_send(session.random.bytes(60))
            dearest = max(dearest, session.cycles_of_tick_alone())
            dearest = max(dearest, session.cycles_of_tick_alone())
            session.rest()
            session.wait(FORGIVEN_MS)
        session.wait(10)  # until all that was sent has been read
        best = sorted([*best, (dearest, values)], key=lambda one: -one[0])[:BEST]
    vectors = session.board.stats().vectors
    return {"tick": best[0][0], **{role: vectors[number].max for role, number in target.vectors.items()}}


def busiest(target: Target, sets: int = SETS, seed: int = 9) -> int:
    """The longest from a tick's interrupt to the end of its tick, in cycles, with both directions of the line full.

    Requests for the longest reply come before a tick, so that the ring of bytes to send is full when it starts, and
    bytes without a gap from then on. With pauses, as the firmware takes a flood for a fault.
    """
    session, draw = Session(target, seed), Random(seed)
    board, random = session.board, session.random
    status = b"\0" + frames.encode_frame(schema.StatusRequest.TYPE, 1, b"")
    longest = 0
    for _ in range(sets):
        session.run_set(parameters(draw))
        session.ask(schema.TelemetryRequest(1))
        for _ in range(TICKS_PER_SET):
            session.wait(3)
            start = session.next_entry()
            board.run_until(start + int(random.integers(10_000, 12_500)))
            board.uart_send(status * int(random.integers(4, 9)))
            board.run_until(start + int(random.integers(14_700, PERIOD - 10)))
            board.uart_send(random.bytes(100))
            session.disturb()
            start = session.next_entry()
            longest = max(longest, session.end_of_tick() - start)
            session.rest()
        session.wait(10)  # until all that was sent has been read
    return longest
