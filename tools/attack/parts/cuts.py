"""Power cuts while a parameter set is being stored, on the real image: old set or new, and a loss is told."""

from __future__ import annotations

from collections import Counter
from functools import partial

import numpy as np

from greywhale.protocol import frames, schema
from greywhale_sim.board_with_image import BoardWithImage
from greywhale_sim.wiring import BOARDS
from tools.attack.copies import in_a_copy
from tools.attack.part import Part, Piece, Row, split

CUTS, PER_PIECE = 10_000, 250
SUPPLY_MV = 5000.0
HISTORIES = ("the first save of a blank EEPROM", "the second save, into the other bank", "the third, over the oldest")
CHANGED = ("kp", "kd", "ki", "zero", "soft_start_ms", "tracking_ms")
SAVE = frames.encode_frame(schema.ParamSaveRequest.TYPE, 9, b"")


def stage_another(bench: BoardWithImage, random: np.random.Generator) -> int:
    """Apply a set that differs in many places from every other, and return its CRC."""
    changes = {
        one.name: min(one.default + int(random.integers(1, 200)), one.maximum)
        for one in schema.PARAMETERS
        if one.name.rpartition(".")[2] in CHANGED
    }
    values = bench.apply(changes, fresh=True)
    bench.wait(20)
    return schema.param_crc(values)


def running_crc(bench: BoardWithImage) -> int:
    return int(bench.ask(schema.HelloRequest()).param_crc)


def cut(bench: BoardWithImage, seed: int) -> None:
    """The supply goes and comes back, at once (even seeds) or on a slope. A byte that was being written is torn."""
    if seed % 2:
        sink(bench, np.random.default_rng(seed), seed)
    else:
        bench.board.power_off(seed)
        bench.board.power_on(seed + 1)
    bench.board.set_millivolts(bench.millivolts)
    bench.wait(80)


def sink(bench: BoardWithImage, random: np.random.Generator, seed: int) -> None:
    """Down to some voltage below the brown-out detector's level within up to 60 ms, and up again as slowly."""
    down = np.linspace(SUPPLY_MV, random.uniform(500.0, 2690.0), int(random.integers(2, 60)))
    for millivolts in (*down, *down[::-1]):
        bench.board.set_supply(round(millivolts), seed)
        bench.board.set_millivolts(bench.millivolts * millivolts / SUPPLY_MV)
        bench.wait(1)


def judge(bench: BoardWithImage, old: int, new: int, changed: bool, saved: bool) -> str:
    """The outcome of a cut; a forbidden one begins with "wrong". `changed`: the EEPROM is not as before the save."""
    running, fault = running_crc(bench), bench.status().fault
    told = fault is schema.Fault.PARAMS
    if running not in (old, new):
        return "wrong: a set that was never stored runs"
    if saved:
        return "new set" if running == new and not told else "wrong: a finished save is lost"
    if running == old and changed and not told:
        return "wrong: the new set is lost without a word"
    if fault not in (schema.Fault.NONE, schema.Fault.PARAMS):
        return f"wrong: fault {fault.key}"
    return f"{'old' if running == old else 'new'} set" + (", told" if told else "")


def is_saved(bench: BoardWithImage) -> bool:
    """Asked in a copy of the board: the question takes time, and the cut shall come now."""
    return in_a_copy(lambda: bench.status().save_state is schema.SaveState.SAVED)


def cut_and_look(bench: BoardWithImage, old: int, new: int, seed: int, before: bytes) -> str:
    """The outcome of a cut now. After it a set is stored again, which must end well."""
    saved = is_saved(bench)
    cut(bench, seed)
    found = judge(bench, old, new, bench.board.eeprom() != before, saved)
    again = stage_another(bench, np.random.default_rng(seed))
    bench.save()
    cut(bench, seed + 2)
    whole = running_crc(bench) == again
    return found if whole else "wrong: the next save did not end well"


def cycles_of_a_save(bench: BoardWithImage) -> int:
    begun = bench.board.cycle
    bench.ask(schema.ParamSaveRequest())
    while bench.status().save_state is not schema.SaveState.SAVED:
        bench.wait(1)
    return int(bench.board.cycle - begun)


def cut_a_save(board: str, earlier: int, trials: int, seed: int) -> Row:
    """Cuts at random cycles of one save, each in a copy of the board that has stored `earlier` sets before."""
    bench, random = BoardWithImage(board), np.random.default_rng((seed, earlier))
    old = running_crc(bench)
    for _ in range(earlier):
        old = stage_another(bench, random)
        bench.save()
    new = stage_another(bench, random)
    before, length = bench.board.eeprom(), in_a_copy(partial(cycles_of_a_save, bench))
    bench.board.uart_send(SAVE)
    begun, found = bench.board.cycle, Counter[str]()
    for number, at in enumerate(np.sort(random.integers(0, round(1.02 * length), trials)).tolist()):
        bench.board.run_until(begun + at)
        found[in_a_copy(partial(cut_and_look, bench, old, new, 11 * number + 1, before))] += 1
    wrong = sum(count for name, count in found.items() if name.startswith("wrong"))
    return Row(f"{board.title()}: {HISTORIES[earlier]}", trials, wrong, dict(sorted(found.items())))


def run(piece: Piece) -> list[Row]:
    return [cut_a_save(piece["board"], piece["earlier"], piece["trials"], piece["seed"])]


def pieces(share: float) -> list[Piece]:
    parts = len(BOARDS) * len(HISTORIES)
    return [
        piece
        for board in BOARDS
        for earlier in range(len(HISTORIES))
        for piece in split(round(CUTS / parts), share, PER_PIECE, board=board, earlier=earlier)
    ]


PART = Part(
    "cuts",
    "Power cuts while parameters are stored",
    """Both boards' real images. The supply goes at a random cycle of a save, at once or on a slope of up to 60 ms
        through the brown-out detector's level, and the byte of EEPROM that was being written is torn. Afterwards the
        old or the new set must run, the new one if its save had ended; a lost new set must be told as the fault
        `params`, unless the EEPROM is bit by bit as before the save. Then another save must end well and
        outlast another cut.""",
    ("firmware/lib", "firmware/src", "shared", "sim/board"),
    pieces,
    run,
)
