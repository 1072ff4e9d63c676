"""The attacks on EEPROMs: a share of each kind, the odds of the CRC, and a store that is broken on purpose."""

from __future__ import annotations

import shutil
from dataclasses import replace
from pathlib import Path

import pytest

from tools.attack import crc
from tools.attack.native import run_counts
from tools.attack.parts import eeprom


def test_pieces_have_every_kind_at_any_share() -> None:
    assert {piece["kind"] for piece in eeprom.pieces(1e-9)} == set(eeprom.TITLES)
    assert sum(piece["trials"] for piece in eeprom.pieces(1.0)) >= 10**7


@pytest.mark.slow
@pytest.mark.parametrize("kind", eeprom.TRIALS)
def test_a_share_holds(kind: str) -> None:
    trials = 500 if kind == "migration" else 20_000
    (row,) = eeprom.run({"kind": kind, "seed": 1, "trials": trials})
    assert (row.trials, row.violations) == (trials, 0)
    assert sum(row.counts.values()) == trials
    assert kind == "migration" or row.counts["lost and told"] > trials / 3


# What stands in the store, and what is put in its place, by the kind that must find it. The first two hide nothing from
# each other; a CRC that does not count would hide the third.
BROKEN = {
    "a CRC that does not count, a blank bank that is no loss": {
        "bytes": ("if (crc.value() != read_u16(static_cast<uint16_t>(at + crc_at))) return false;", ""),
        "erased": ("!never_used(b, good[b ^ 1], sequences[b ^ 1])", "!blank(b)"),
    },
    "no defaults for what an old set lacks": {"migration": ("load_defaults(table);\n  for", "for")},
}


@pytest.mark.slow
@pytest.mark.parametrize("name", BROKEN)
def test_a_broken_store_is_found(tmp_path: Path, name: str) -> None:
    firmware = tmp_path / "lib"
    shutil.copytree(eeprom.PROGRAM.firmware, firmware)
    store = firmware / "params/src/params/store.h"
    text = store.read_text(encoding="utf-8")
    for right, wrong in BROKEN[name].values():
        assert right in text
        text = text.replace(right, wrong)
    store.write_text(text, encoding="utf-8")
    quickly = tuple("-O0" if word == "-O2" else word for word in eeprom.PROGRAM.command)
    broken = replace(eeprom.PROGRAM, name="broken_eeprom", firmware=firmware, command=quickly)
    for kind in BROKEN[name]:
        assert eeprom.judge(kind, run_counts(broken, [kind, 1, 2000])).violations > 100


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


def test_more_than_chance_is_too_many() -> None:
    assert crc.too_many(150, 152.0) == 0
    assert crc.too_many(300, 152.0) > 0
    assert crc.too_many(100, 0.0) > 0
