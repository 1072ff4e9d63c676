"""The attacks on the line: a share of each kind, and firmware and decoders that are broken on purpose."""

from __future__ import annotations

import shutil
from dataclasses import replace
from pathlib import Path

import pytest

from tools.attack.native import run_counts
from tools.attack.parts import link


def test_pieces_have_every_kind_at_any_share() -> None:
    kinds = {(piece["what"], piece["how"]) for piece in link.pieces(1e-9)}
    assert len(kinds) == len(link.SESSIONS) + len(link.REPLIES) + len(link.FLIPPED)
    assert sum(piece["trials"] for piece in link.pieces(1.0) if piece["what"] == "session") >= 10**7


@pytest.mark.slow
@pytest.mark.parametrize("rate", link.SESSIONS)
def test_sessions_hold(rate: int) -> None:
    faults = max(50, rate // 2)
    (row,) = link.run({"what": "session", "how": rate, "seed": 1, "trials": faults})
    assert faults <= row.trials < faults + 100, "the last turn of each session may have more than it needs"
    assert row.violations == 0
    assert row.counts["applied"] > 10
    assert row.counts["frames hit"] > faults / 2


@pytest.mark.slow
@pytest.mark.parametrize("rate", link.REPLIES)
def test_the_hosts_decoder_holds(rate: int) -> None:
    (row,) = link.run({"what": "replies", "how": rate, "seed": 1, "trials": 5000})
    assert row.violations == 0
    assert row.counts["frames"] > 1000


@pytest.mark.slow
@pytest.mark.parametrize("bits", link.FLIPPED)
def test_flipped_bits_pass_as_computed(bits: int) -> None:
    (row,) = link.run({"what": "flips", "how": bits, "seed": 1, "trials": 200_000})
    assert (row.trials, row.violations) == (200_000, 0)


CRC_COUNTS = "if (crc_over(buffer_, body) == get_u16(buffer_ + body)) return true;"
ONE_BYTE = "if (static_cast<uint8_t>(crc_over(buffer_, body)) == buffer_[body]) return true;"
BROKEN = [
    ("link/src/link/frame.cpp", CRC_COUNTS, "if (crc_over(buffer_, body) || body) return true;", "session"),
    ("link/src/link/frame.cpp", CRC_COUNTS, ONE_BYTE, "flips"),
]


@pytest.mark.slow
@pytest.mark.parametrize(
    ("file", "right", "wrong", "what"),
    BROKEN,
    ids=["a CRC that does not count", "a CRC of eight bits"],
)
def test_a_broken_link_is_found(tmp_path: Path, file: str, right: str, wrong: str, what: str) -> None:
    firmware = tmp_path / "lib"
    shutil.copytree(link.PROGRAM.firmware, firmware)
    text = (firmware / file).read_text(encoding="utf-8")
    assert right in text
    (firmware / file).write_text(text.replace(right, wrong), encoding="utf-8")
    broken = replace(link.PROGRAM, name="broken_link", firmware=firmware)
    if what == "session":
        row = link.judge_session(50_000, run_counts(broken, ["session", 1, 20_000, 50_000]))
    else:
        row = link.judge_flips(4, run_counts(broken, ["flips", 1, 100_000, 4]))
    assert row.violations > 0


@pytest.mark.slow
def test_a_decoder_that_misses_or_invents_is_found() -> None:
    records = list(link.read_replies(["replies", 1, 200, 10_000]))
    silent = [(frame, b"", must) for frame, _, must in records]
    assert link.judge_replies(10_000, 200, iter(silent)).violations > 100
    foreign = [(records[0][0], frame, False) for frame, _, must in records[1:] if must]
    assert link.judge_replies(10_000, 200, iter(foreign)).violations > 100
