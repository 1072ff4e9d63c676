"""eFLL, Arduino's fuzzy library, beside our laws: cycles, flash and RAM on the simulated ATmega2560, and the error.

eFLL is not part of this project: GREYWHALE_EFLL names a folder with its sources, https://github.com/alvesoaj/eFLL.
"""

from __future__ import annotations

import os
import struct
import subprocess
import sys
import tempfile
from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from fractions import Fraction
from pathlib import Path

import numpy as np

from greywhale._native import Board
from greywhale.base.types import Floats
from greywhale.files import fis
from greywhale.fuzzy import load_joints
from greywhale.fuzzy.export_fis import fis_text
from greywhale.fuzzy.export_header import make_header
from greywhale.fuzzy.header_proof import exact_u
from greywhale.fuzzy.table_law import Axis, Corners, TableLaw, from_fis
from greywhale.fuzzy.table_twin import END, Ints
from greywhale_sim.programs import load_elf
from greywhale_sim.symbols import read_symbols
from tools import ROOT, avr_tool
from tools.benchmarks.figure import Figure
from tools.support.fis_files import table
from tools.support.header_on_board import FLAGS, HeaderOnBoard

CHIP = "atmega2560"
PLACES, SEED = 3_000, 0
LIMIT = 20_000_000  # cycles of a call
SETUP_CYCLES = 4_000_000  # building the objects takes less
RAM_END = 0x2200
UNUSED = 0xA5  # what memory holds that nothing has written
EMPTY = "int main() { return 0; }\n"
# Arduino's core has these; avr-libc has not.
NEW = """
#include <stdlib.h>
void* operator new(size_t size) { return malloc(size); }
void operator delete(void* at) { free(at); }
void operator delete(void* at, size_t) { free(at); }
"""
PROGRAM = """
#include "Fuzzy.h"
static Fuzzy law;
static bool whole = true;
static FuzzySet* sets[3][{most}];
{numbers}
extern "C" __attribute__((noinline, used)) float law_u(float e, float ce) {{
  law.setInput(1, e);
  law.setInput(2, ce);
  law.fuzzify();
  return law.defuzzify(1);
}}
extern "C" __attribute__((noinline, used)) bool law_whole() {{ return whole; }}
int main() {{
  FuzzyInput* inputs[2] = {{new FuzzyInput(1), new FuzzyInput(2)}};
  FuzzyOutput* output = new FuzzyOutput(1);
  for (uint8_t of = 0; of < 3; ++of) {{
    for (uint8_t k = 0; k < counts[of]; ++k) {{
      const float* at = corners[of][k];
      sets[of][k] = new FuzzySet(at[0], at[1], at[2], at[3]);
      FuzzyIO* to = of < 2 ? (FuzzyIO*)inputs[of] : (FuzzyIO*)output;
      whole = whole && sets[of][k] && to->addFuzzySet(sets[of][k]);
    }}
  }}
  whole = whole && law.addFuzzyInput(inputs[0]) && law.addFuzzyInput(inputs[1]) && law.addFuzzyOutput(output);
  int number = 1;
  for (uint8_t i = 0; i < counts[0]; ++i) {{
    for (uint8_t j = 0; j < counts[1]; ++j) {{
      FuzzyRuleAntecedent* both = new FuzzyRuleAntecedent();
      FuzzyRuleConsequent* then = new FuzzyRuleConsequent();
      whole = whole && both && both->joinWithAND(sets[0][i], sets[1][j]);
      whole = whole && then && then->addOutput(sets[2][rules[i][j]]);
      FuzzyRule* rule = new FuzzyRule(number++, both, then);
      whole = whole && rule && law.addFuzzyRule(rule);
    }}
  }}
  for (;;) {{
  }}
}}
"""


@dataclass(frozen=True)
class Law:
    """A law by its name, as we read it, and the output's sets as eFLL takes them; `half` is half their range.

    `scale` takes our places to its own: the firmware's singletons are equal triangles of ours in a wider range.
    """

    name: str
    ours: TableLaw
    output: tuple[Corners, ...]
    half: Fraction
    scale: float = 1.0


def run() -> list[Figure]:
    folder = Path(os.environ.get("GREYWHALE_EFLL", ""))
    if not (folder / "Fuzzy.h").is_file():
        print(
            "GREYWHALE_EFLL names no folder with eFLL's Fuzzy.h; docs/library.md says where it comes from.",
            file=sys.stderr,
        )
        return []
    with tempfile.TemporaryDirectory() as at:
        build = Path(at)
        empty = _flash(_compiled(EMPTY, build / "empty.elf"))
        figures = []
        for law in _laws():
            figures += _efll(law, folder, build, empty)
            if law.half == law.ours.output.high or law.scale != 1.0:
                figures += _header(law, build, empty)
        return figures


def _laws() -> Iterator[Law]:
    joint = load_joints(ROOT / "shared/fuzzy_tables/table_10.toml")[0]
    sets = {key: float(value) for key, value in joint.set_values().items()}
    # The firmware's: heights as weights of -1, 0 and 1. As a centroid it needs triangles, see export_fis.
    firmware = from_fis(fis.parse(fis_text("joint", sets)), "joint")
    peaks = tuple((one[1],) * 4 for one in firmware.output.sets)
    yield Law("3 x 3, a joint of Table 10", firmware, peaks, Fraction(1), float(firmware.output.high))
    for size in (3, 7):
        ours = from_fis(fis.parse(table(size)), f"table{size}")
        # The exact centroid is of the area within the range; eFLL has no range. Its points of 0.001 count as one.
        for half in (ours.output.high, Fraction(1)):
            unit = half / ours.output.high
            a, b, c, d = ([min(max(one[k] * unit, -half), half) for one in ours.output.sets] for k in range(4))
            yield Law(f"{size} x {size}, triangles to {half}", ours, tuple(zip(a, b, c, d, strict=True)), half)


def _places() -> tuple[Ints, Ints]:
    """Inputs, half of them near the middle, where a controller works."""
    random = np.random.default_rng(SEED)
    e, ce = random.integers(-END, END + 1, (2, PLACES))
    near = random.integers(0, 2, PLACES) == 0
    return np.where(near, e // 16, e), np.where(near, ce // 16, ce)


def _efll(law: Law, folder: Path, build: Path, empty: int) -> list[Figure]:
    elf = _compiled(NEW + _program(law), build / "efll.elf", folder, sorted(folder.glob("Fuzzy*.cpp")))
    board, symbols = Board(CHIP), read_symbols(elf)
    load_elf(board, elf)
    board.power_on(1)
    board.run_until(SETUP_CYCLES)
    board.call(symbols["law_whole"].address, LIMIT)
    assert board.peek(24)[0] == 1, "eFLL ran out of memory"
    heap = symbols["__brkval"].address
    e, ce = _places()
    inputs = [_real(axis, x) for axis, x in zip(law.ours.inputs, (e, ce), strict=True)]
    cycles, answers, ram = [], [], 0
    stack = struct.unpack("<H", board.peek(0x5D, 2))[0]
    for pair in zip(*(one.tolist() for one in inputs), strict=True):
        top = struct.unpack("<H", board.peek(heap, 2))[0]
        board.poke(top, bytes([UNUSED]) * (stack - top))
        board.poke(18, struct.pack("<ff", *reversed(pair)))
        cycles.append(board.call(symbols["law_u"].address, LIMIT))
        answers.append(struct.unpack("<f", board.peek(22, 4))[0])
        used = np.frombuffer(board.peek(top, RAM_END - top), np.uint8) != UNUSED
        ram = max(ram, top - 0x200 + int(used.sum()))
    return _figures(f"eFLL, {law.name}", law, cycles, _off(law, np.array(answers), e, ce), _flash(elf) - empty, ram)


def _header(law: Law, build: Path, empty: int) -> list[Figure]:
    path = build / "law.h"
    path.write_text(make_header(law.ours, law.name, path.name).text)
    board = HeaderOnBoard(path, CHIP)
    e, ce = _places()
    answers, cycles = zip(*(board.u(*pair) for pair in zip(e.tolist(), ce.tolist(), strict=True)), strict=True)
    off = np.abs(np.array(answers) - exact_u(law.ours, e, ce)) * law.scale
    return _figures(f"export --header, {law.name}", law, cycles, off, _flash(path.with_suffix(".elf")) - empty, None)


def _figures(name: str, law: Law, cycles: Sequence[int], off: Floats, flash: int, ram: int | None) -> list[Figure]:
    figures = [
        Figure(f"{name}: mean", float(np.mean(cycles)), "cycles"),
        Figure(f"{name}: most", max(cycles), "cycles"),
        Figure(f"{name}: flash", flash, "bytes"),
        Figure(f"{name}: greatest error", float(off.max()), "LSB"),
        Figure(f"{name}: mean error", float(off.mean()), "LSB"),
    ]
    return figures if ram is None else [*figures, Figure(f"{name}: variables, heap and stack", ram, "bytes")]


def _off(law: Law, answers: Floats, e: Ints, ce: Ints) -> Floats:
    """The distance from the exact centroid in LSB, 1/16384 of half the output's range."""
    return np.abs(answers / float(law.half) * END - exact_u(law.ours, e, ce) * law.scale)


def _real(axis: Axis, x: Ints) -> Floats:
    low, high = float(axis.low), float(axis.high)
    return (low + high) / 2 + x / END * (high - low) / 2


def _program(law: Law) -> str:
    sets = (law.ours.inputs[0].sets, law.ours.inputs[1].sets, law.output)
    most = max(map(len, sets))
    corners = ",\n".join("{" + ", ".join(_floats(one) for one in some) + "}" for some in sets)
    rules = ", ".join("{" + ", ".join(map(str, row)) + "}" for row in law.ours.table)
    numbers = [
        f"static const uint8_t counts[3] = {{{', '.join(str(len(some)) for some in sets)}}};",
        f"static const float corners[3][{most}][4] = {{{corners}}};",
        f"static const uint8_t rules[{len(sets[0])}][{len(sets[1])}] = {{{rules}}};",
    ]
    return PROGRAM.format(most=most, numbers="\n".join(numbers))


def _floats(corners: Corners) -> str:
    return "{" + ", ".join(f"{float(one)!r}f" for one in corners) + "}"


def _compiled(program: str, elf: Path, folder: Path | None = None, sources: Sequence[Path] = ()) -> Path:
    """As Arduino compiles a sketch and a library, without what neither calls."""
    flags = [one for one in FLAGS if not one.startswith("-W")]
    flags += ["-w", f"-mmcu={CHIP}", "-ffunction-sections", "-fdata-sections", "-Wl,--gc-sections"]
    own = elf.with_suffix(".cpp")
    own.write_text(program)
    include = [] if folder is None else [f"-I{folder}", *(f"-Wl,-u,{name}" for name in ("law_u", "law_whole"))]
    command = [avr_tool("avr-g++"), *flags, *include, str(own), *map(str, sources), "-lm", "-o", str(elf)]
    subprocess.run(command, check=True)
    return elf


def _flash(elf: Path) -> int:
    lines = subprocess.run([avr_tool("avr-size"), str(elf)], check=True, capture_output=True, text=True).stdout
    text, data, *_ = lines.splitlines()[1].split()
    return int(text) + int(data)
