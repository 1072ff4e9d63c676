"""libFuzzer with sanitizers over the firmware: the whole App, the frames, the parameter table."""

from __future__ import annotations

import re
import shutil
import subprocess
import tempfile
import zipfile
from collections.abc import Sequence
from functools import cache
from pathlib import Path

from tools import ROOT
from tools.attack.native import ROOMS_OF_SETS, SOURCES, WATCHED, Program, build, depends
from tools.attack.part import Part, Piece, Row, split
from tools.attack.stories import STORIES

CORPUS = SOURCES / "corpus"
FOUND = ROOT / "build/attack/found"  # inputs that broke something
COMMAND = (*WATCHED, "-fsanitize=fuzzer,address,undefined")
TARGETS = {
    "app": Program("fuzz_app", ("fuzz_app", "watcher", "law", "machine"), COMMAND),
    "frames": Program("fuzz_frames", ("fuzz_frames",), COMMAND, "link/src/link/*.cpp"),
    "table": Program("fuzz_table", ("fuzz_table", "law"), COMMAND, ROOMS_OF_SETS),
}
TITLES = {
    "app": "the whole firmware",
    "frames": "the frame codec",
    "table": "the parameter table and its EEPROM",
}
RUNS = {"app": (180_000, 10_000), "frames": (2_000_000, 1_000_000), "table": (300_000, 150_000)}  # in all, in a piece
LIMITS = ("-max_len=512", "-timeout=60", "-rss_limit_mb=2048")


def pieces(share: float) -> list[Piece]:
    return [piece for target, (runs, size) in RUNS.items() for piece in split(runs, share, size, target=target)]


def run(piece: Piece) -> list[Row]:
    return [fuzz(TARGETS[piece["target"]], piece["target"], piece["seed"], piece["trials"])]


def fuzz(program: Program, target: str, seed: int, runs: int) -> Row:
    """So many runs from the corpus on. The first input that breaks something ends them, and is kept in FOUND."""
    with tempfile.TemporaryDirectory() as folder:
        inputs = unpack(target, Path(folder))
        options = [f"-seed={seed + 1}", f"-runs={runs}", f"-artifact_prefix={FOUND}/{target}-{seed}-"]
        listed = Path(folder, "inputs")
        listed.write_text(",".join(map(str, inputs)), encoding="utf-8")
        failed, report = launch(program, [*options, f"-seed_inputs=@{listed}"])
    if failed:
        print(f"\n{target}, seed {seed}: {reason(report)}", flush=True)
    return Row(TITLES[target], runs_done(report), int(failed))


def replay(program: Program, target: str) -> tuple[bool, str]:
    """Every input of the corpus once: whether something broke, and the report."""
    with tempfile.TemporaryDirectory() as folder:
        return launch(program, [*map(str, unpack(target, Path(folder))), f"-artifact_prefix={folder}/"])


def launch(program: Program, arguments: Sequence[str]) -> tuple[bool, str]:
    FOUND.mkdir(parents=True, exist_ok=True)
    command = [*fixed_addresses(), str(build(program)), *LIMITS, "-print_final_stats=1", *arguments]
    done = subprocess.run(command, stdout=subprocess.DEVNULL, stderr=subprocess.PIPE, text=True, errors="replace")
    return done.returncode != 0, done.stderr


@cache
def fixed_addresses() -> tuple[str, ...]:
    """Words to put before a command so that a seed makes the same runs every time: libFuzzer takes addresses for
    numbers to try. None where the system does not allow it."""
    command = ("setarch", "--addr-no-randomize")
    allowed = shutil.which(command[0]) and subprocess.run([*command, "true"], stderr=subprocess.DEVNULL).returncode == 0
    return command if allowed else ()


def unpack(target: str, folder: Path) -> list[Path]:
    """The inputs of the corpus as files, in an order that is always the same."""
    with zipfile.ZipFile(CORPUS / f"{target}.zip") as packed:
        packed.extractall(folder)
    for number, story in enumerate(STORIES.values() if target == "app" else []):
        (folder / f"story{number:02}").write_bytes(story)
    return sorted(folder.iterdir())


def runs_done(report: str) -> int:
    found = re.search(r"stat::number_of_executed_units: (\d+)", report)
    return int(found[1]) if found else 0


def reason(report: str) -> str:
    """The line that says what broke."""
    found = re.search(r"^(VIOLATION.*|.*runtime error.*|==\d+==ERROR.*|==\d+== ERROR.*)$", report, re.MULTILINE)
    return found[1] if found else report[-300:]


PART = Part(
    "fuzz",
    "Fuzzing the firmware",
    """libFuzzer searches for inputs that break something, guided by the code they reach, from a corpus that every
`make test` replays, under AddressSanitizer and UndefinedBehaviorSanitizer. A trial is a run of one input. The first
that breaks something ends its piece, and is one violation.

An input for the whole firmware is a list of deeds: requests with any values, any frames and bytes, up to 2,000 ticks at
once, potentiometers that jump or are shaken, an arm that follows well or badly, late and missing samples, lost bytes, a
wire that does not take replies, the emergency stop, power cuts, damaged EEPROM cells. What must hold, seen through
line, pins and EEPROM:

A set runs after an apply with its CRC and the motors off, or after unrest its safe form; it can be run, and is what was
staged, value by value. After a boot the set that was saved last runs. Only enable, lead and the board itself after
unrest start the motors. They are off with the reply to a stop, after a late tick, in the third tick with a
potentiometer at a rail, in the tick that sees the emergency stop, and when the lease ends. The voltage is the running
set's, to the millivolt, from the angles that the board reports, within supply and soft start; the duty is the nearest
one. A host that leads has a lease, stays within the limits and cannot make the reference jump. The work between two
ticks comes to rest; every request is answered.

The frame codec is judged by a second decoder, written from the definition of COBS and the CRC; the parameter table by
the ranges of its values.""",
    (*depends(*TARGETS.values()), "firmware/test/attack/corpus", "tools/attack/stories.py"),
    pieces,
    run,
)
