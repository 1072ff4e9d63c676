"""Damaged EEPROMs: what runs after a boot, and whether a loss is told."""

from __future__ import annotations

from tools.attack import crc
from tools.attack.native import FAST, ROOMS_OF_SETS, Program, depends, run_counts
from tools.attack.part import Part, Piece, Row, split

PROGRAM = Program("eeprom_faults", ("eeprom_faults", "sets"), FAST, ROOMS_OF_SETS)
BANK_BITS = 203 * 8
SUMMED_BITS = (2 + 194 + 2) * 8  # sequence, table and CRC: damage to the rest of a bank is always noticed
PIECE, SAVES_PIECE = 5_000_000, 200_000

TRIALS = {f"bits{count}": 5_000_000 for count in range(1, 9)} | {
    "bytes": 10_000_000,
    "runs": 10_000_000,
    "swapped": 10_000_000,
    "erased": 5_000_000,
    "old": 10_000_000,
    "migration": 1_000_000,
}
TITLES = {f"bits{count}": f"{count} bit{'s' * (count > 1)} flipped in a bank" for count in range(1, 9)} | {
    "bytes": "1 to 8 bytes changed in a bank",
    "runs": "a run of 2 to 300 bytes erased, cleared or overwritten",
    "swapped": "the banks, or a part of them, swapped",
    "erased": "a bank erased whole",
    "old": "1 to 8 bytes changed, with banks of layout 1",
    "migration": "from layout 1: boot, save, boot, loss of the newest bank",
}


def collision_share(kind: str) -> float:
    """The share of trials in which a damaged bank has the right CRC by chance, at most."""
    if kind.startswith("bits"):
        return crc.unnoticed_share(SUMMED_BITS, int(kind.removeprefix("bits")), BANK_BITS)
    if kind in {"erased", "migration"}:
        return 0.0
    if kind == "old":
        return 2 * crc.RANDOM  # few bits at times: an even number of them passes with 2^-15
    return 2 * crc.RANDOM if kind in {"runs", "swapped"} else crc.RANDOM  # both banks may be damaged


def pieces(share: float) -> list[Piece]:
    size = {"migration": SAVES_PIECE}
    return [
        piece for kind, trials in TRIALS.items() for piece in split(trials, share, size.get(kind, PIECE), kind=kind)
    ]


def run(piece: Piece) -> list[Row]:
    kind, trials = piece["kind"], piece["trials"]
    return [judge(kind, run_counts(PROGRAM, [kind, piece["seed"], trials]))]


def judge(kind: str, counts: dict[str, int]) -> Row:
    """A wrong set and a loss that is not told are violations; so are more collisions than chance explains."""
    trials, share = counts.pop("trials"), collision_share(kind)
    broken = counts.pop("wrong set", 0) + counts.pop("untold", 0)
    broken += crc.too_many(counts.get("collisions", 0), share * trials)
    worst = {"collisions expected in a million, at most": share * 1e6} if share else {}
    return Row(TITLES[kind], trials, broken, counts, worst)


PART = Part(
    "eeprom",
    "Damaged parameter sets",
    """Boards that have saved three to six random sets are damaged and booted (on a computer, the firmware's own code).
The set that was saved last must run. If its bank is damaged, the one before it or the defaults must run, and the
loss must be told: the fault `params` stands. A set that was never saved must not run. What a CRC of 16 bits
cannot see is counted as a collision: a damaged bank whose magic, layout, length and CRC are right by chance,
looked up with a second implementation of the CRC. Beside it stands how many are expected, from the CRC's own
weights; ranges and rules between parameters refuse some of these. More than chance explains would be violations.

Two cases cannot be told, and are not tried: a board whose EEPROM was erased whole is as good as new, and a board
that has saved exactly twice and whose second bank was then erased whole looks like one that has saved once.

Of the earlier layouts the oldest, 1, is tried. From it every random set must come over with today's defaults for
what it lacks, a save must leave a whole bank of today, and when that is lost, the old one must run and the loss must be
told.

Wear: a cell is made for 100,000 writes. A save writes each cell of one bank at most once, and the first byte of
that bank twice; the banks take turns. So each cell is written at most once per save on average, and the first one
in a bank lasts for 100,000 saves: ten a day for 27 years. A save of what is stored already writes nothing, and a
byte that is right already is not written. Nothing else writes the EEPROM. The number of saves stands in the newer
bank, modulo 65,536 (its sequence).""",
    (*depends(PROGRAM), "tools/attack/crc.py"),
    pieces,
    run,
)
