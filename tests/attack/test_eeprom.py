"""Damaged EEPROMs: the set that was saved last runs after a boot, or one before it does and the loss is told."""

from __future__ import annotations

import pytest

from tools.attack import chance
from tools.attack.native import FAST, ROOMS_OF_SETS, Program, run_counts

pytestmark = pytest.mark.slow
PROGRAM = Program("eeprom_faults", ("eeprom_faults", "sets"), FAST, ROOMS_OF_SETS)
SEED, DAMAGED, MIGRATED = 1, 20_000, 500
# 1 to 8 flipped bits in a bank; 1 to 8 bytes changed, also where banks are of an older layout; a run of 2 to 300 bytes
# erased, cleared or overwritten; the banks, or a part of them, swapped; a bank erased whole.
DAMAGES = (*(f"bits{count}" for count in range(1, 9)), "bytes", "old", "runs", "swapped", "erased")
MOST_MATCHES = 2 * chance.CRC_MATCH  # both banks may be damaged; an even number of flipped bits passes with 2^-15


@pytest.mark.parametrize("damage", DAMAGES)
def test_a_damaged_bank_is_noticed_and_an_older_set_runs(damage: str) -> None:
    counts = run_counts(PROGRAM, [damage, SEED, DAMAGED])
    matches = counts.pop("collisions", 0)
    assert set(counts) == {"trials", "newest runs", "lost and told"}
    assert counts["lost and told"] > DAMAGED / 3
    assert not chance.too_many(matches, MOST_MATCHES * DAMAGED)
    if damage in {"bits1", "bits2", "bits3", "erased"}:
        assert matches == 0, "a CRC notices any three bits"


def test_sets_of_an_older_firmware_come_over_and_are_saved_whole() -> None:
    """After the loss of the new bank, the old one runs, and that is told."""
    assert run_counts(PROGRAM, ["migration", SEED, MIGRATED]) == {"trials": MIGRATED, "migrated": MIGRATED}
