"""The attacks on EEPROMs: a share of each kind, and the odds of the CRC."""

from __future__ import annotations

import pytest

from tools.attack import crc
from tools.attack.parts import eeprom


@pytest.mark.slow
@pytest.mark.parametrize("kind", eeprom.TRIALS)
def test_a_share_holds(kind: str) -> None:
    trials = 500 if kind == "migration" else 20_000
    (row,) = eeprom.run({"kind": kind, "seed": 1, "trials": trials})
    assert (row.trials, row.violations) == (trials, 0)
    assert sum(row.counts.values()) == trials
    assert kind == "migration" or row.counts["lost and told"] > trials / 3


def test_the_odds_of_the_crc_are_those_of_all_words() -> None:
    bits, data = 26, 10
    words = []
    for value in range(1 << data):
        register = 0
        for bit in reversed(range(data)):
            feedback = (register >> 15 ^ value >> bit) & 1
            register = (register << 1 & 0xFFFF) ^ (crc.POLYNOMIAL if feedback else 0)
        words.append((value << 16 | register).bit_count())
    assert [crc.unnoticed_patterns(bits, weight) for weight in range(9)] == [words.count(weight) for weight in range(9)]


def test_up_to_three_flipped_bits_never_pass() -> None:
    assert [crc.unnoticed_patterns(eeprom.SUMMED_BITS, weight) for weight in (1, 2, 3, 5, 7)] == [0] * 5
    assert crc.unnoticed_patterns(eeprom.SUMMED_BITS, 4) > 0
