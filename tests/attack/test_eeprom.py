"""Damaged EEPROMs: the set that was saved last runs after a boot, or one before it does and the loss is told."""

from __future__ import annotations

import pytest
from scipy.stats import poisson

from tools.attack import chance
from tools.attack.native import FAST, ROOMS_OF_SETS, Program, run_counts

pytestmark = pytest.mark.slow
PROGRAM = Program("eeprom_faults", ("eeprom_faults", "sets"), FAST, ROOMS_OF_SETS)
SEED, DAMAGED, MIGRATED = 1, 20_000, 500
# The share of each damage that passes the CRC by chance. Its polynomial is divisible by x + 1 and its period is
# longer than a bank: no odd number of flipped bits passes, nor do two. So of an even number twice as many pass as of
# other damage. An erased bank has no magic.
CRC_ODDS = {
    **{f"bits{count}": 0.0 if count % 2 or count == 2 else 2 * chance.CRC_MATCH for count in range(1, 9)},
    "bytes": chance.CRC_MATCH,  # 1 to 8 of them changed
    "old": chance.CRC_MATCH,  # the same, where banks are of an older layout
    "runs": chance.CRC_MATCH,  # of 2 to 300 bytes erased, cleared or overwritten; only the first bank keeps its magic
    "swapped": chance.CRC_MATCH,  # the banks, or a part of them: what passes in one bank passes in both
    "erased": 0.0,  # a bank, whole
}
RARE = 1e-4  # a change of the table draws all damages anew, and must not fail here by chance


@pytest.mark.parametrize(("damage", "odds"), CRC_ODDS.items(), ids=CRC_ODDS)
def test_a_damaged_bank_is_noticed_and_an_older_set_runs(damage: str, odds: float) -> None:
    counts = run_counts(PROGRAM, [damage, SEED, DAMAGED])
    matches = counts.pop("collisions", 0)
    assert set(counts) == {"trials", "newest runs", "lost and told"}
    assert counts["lost and told"] > DAMAGED / 3
    assert matches <= (poisson.isf(RARE, odds * DAMAGED) if odds else 0)


def test_sets_of_an_older_firmware_come_over_and_are_saved_whole() -> None:
    """After the loss of the new bank, the old one runs, and that is told."""
    assert run_counts(PROGRAM, ["migration", SEED, MIGRATED]) == {"trials": MIGRATED, "migrated": MIGRATED}
