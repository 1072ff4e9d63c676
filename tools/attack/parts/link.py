"""A line that damages bytes: what acts, what runs, how soon the next frame is understood."""

from __future__ import annotations

import subprocess
from collections.abc import Iterator

from greywhale.protocol.frames import FrameDecoder, decode_frame
from tools.attack import chance
from tools.attack.native import FAST, Program, build, depends, run_counts
from tools.attack.part import Part, Piece, Row, split

PROGRAM = Program("link_faults", ("link_faults", "channel", "host", "machine", "sets"), FAST)
# Faults in a million bytes: how many in all, and in a piece of some 20 s.
SESSIONS = {
    100: (40_000, 5_000),
    1_000: (1_000_000, 100_000),
    10_000: (4_000_000, 800_000),
    50_000: (8_000_000, 4_000_000),
}
REPLIES = {10_000: (200_000, 100_000), 50_000: (200_000, 100_000)}
BROKEN = ("wrong set", "started by chance", "on after stop", "whole but not understood", "slow recovery")


def pieces(share: float) -> list[Piece]:
    return [
        piece
        for what, plan in (("session", SESSIONS), ("replies", REPLIES))
        for rate, (faults, size) in plan.items()
        for piece in split(faults, share, size, what=what, how=rate)
    ]


def run(piece: Piece) -> list[Row]:
    arguments = [piece["what"], piece["seed"], piece["trials"], piece["how"]]
    if piece["what"] == "replies":
        return [judge_replies(piece["how"], piece["trials"], read_replies(arguments))]
    return [judge_session(piece["how"], run_counts(PROGRAM, arguments))]


def judge_session(rate: int, counts: dict[str, int]) -> Row:
    """Of the damaged pieces of the line one in 65,536 may pass. More than chance explains are violations."""
    broken = sum(counts.pop(name, 0) for name in BROKEN)
    expected = (counts["faults"] + counts["frames hit"]) * chance.CRC_MATCH
    broken += chance.too_many(counts.get("passed by chance", 0), expected)
    shown = {"frames hit", "applied", "passed by chance", "acted by chance"}
    return Row(
        f"board: {rate / 1e4:g} % of the bytes hit",
        counts["faults"],
        broken,
        {"frames": counts["frames"]} | {name: count for name, count in counts.items() if name in shown},
        {"bytes until a frame was understood": float(counts.get("worst recovery", 0))},
    )


Reply = tuple[bytes, bytes, bool]  # what was sent, what came, whether it must be understood


def read_replies(arguments: list[object]) -> Iterator[Reply]:
    data = subprocess.run([str(build(PROGRAM)), *map(str, arguments)], stdout=subprocess.PIPE, check=True).stdout
    at = 0
    while at < len(data):
        middle = at + 1 + data[at]
        end = middle + 1 + data[middle]
        yield data[at + 1 : middle], data[middle + 1 : end], bool(data[end])
        at = end + 1


def judge_replies(rate: int, faults: int, replies: Iterator[Reply]) -> Row:
    """The host's decoder: every whole frame behind a zero comes out, and nothing else but by chance."""
    decoder = FrameDecoder()
    recent = [decode_frame(b"")] * 4
    frames = missed = passed = 0
    for sent, came, must in replies:
        recent = [*recent[1:], decode_frame(sent[:-1])]
        got = decoder.feed(came)
        missed += must and (not got or got[-1] != recent[-1])
        passed += sum(frame not in recent for frame in got)
        frames += 1
    broken = missed + chance.too_many(passed, 2 * faults * chance.CRC_MATCH)
    return Row(
        f"host: {rate / 1e4:g} % of the bytes hit", faults, broken, {"frames": frames, "passed by chance": passed}
    )


PART = Part(
    "link",
    "A bad line",
    """A host works with the board (the firmware's own code on a computer) by requests of all kinds, and repeats what is
not answered. On the way to the board bytes are hit, each way as often: a flipped bit, a burst of 2 to 8 random bytes, a
byte lost, doubled, inserted or swapped with the next, a frame cut short, two spliced, 1 to 40 bytes of garbage between
frames.

What must hold: a set that runs is the one that this host meant, value by value. A stop that is understood turns the
motors off. No damaged frame starts them. Every frame that comes whole behind a zero is understood within 108 bytes
after a fault (two of the longest frames, 1.1 ms). No more damage acts than a CRC of 16 bits lets pass by chance, one
piece in 65,536, of which COBS refuses most; what acted staged a value that the CRC of the apply then refused, moved the
reference by a wrong step, or set another lease.

The other way, the host's decoder takes samples and status over the same line.""",
    (*depends(PROGRAM), "tools/attack/chance.py", "host/src/greywhale/protocol"),
    pieces,
    run,
)
