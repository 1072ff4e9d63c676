"""Bounds of hand-written functions against their exact cycles on the simulated board, and their sum."""

from __future__ import annotations

import random
from pathlib import Path

import pytest

from tests.gates.timing.programs import Assembled, Compiled
from tools.gates.timing.bound import Timing
from tools.gates.timing.cycles import MEGA, NANO, Chip
from tools.gates.timing.facts import Facts
from tools.gates.timing.image import Times
from tools.gates.timing.listing import ImageError

CHIPS = pytest.mark.parametrize("chip", [MEGA, NANO], ids=lambda chip: chip.name)

# Which way is taken depends on r24, and 5 is on the dearest one.
DIAMOND = """
  cpi r24, 5
  brne 1f
  mul r24, r24
  mul r24, r24
  rjmp 2f
1:nop
2:sbrc r24, 0
  sts 0x200, r24
  sbrs r24, 0
  rjmp 3f
  nop
3:clr r1
  ret
"""
COUNTED = """
  andi r24, 7
  inc r24
1:ldi r25, 4
2:dec r25
  brne 2b
  dec r24
  brne 1b
  ret
"""
HELPER = """
helper:
  tst r24
  breq 1f
  nop
  nop
1:ret
"""
SWITCH = """
#include <stdint.h>
volatile uint8_t sink;
volatile uint16_t wide = 3;
extern "C" __attribute__((noinline, used)) void work(uint8_t what) {
  switch (what) {
    case 0: sink = 7; break;
    case 1: wide = wide + 9; break;
    case 2: sink = sink ^ 0x55; sink = 3; break;
    case 3: wide = wide * wide; break;
    case 4: wide = wide << 3; break;
    case 5: sink = 1; sink = 2; break;
    case 6: wide = 0; break;
    case 7: wide = wide * 77; sink = 5; break;
    default: sink = 0;
  }
}
int main() { work(sink); }
"""


@CHIPS
@pytest.mark.parametrize(
    ("body", "times", "dearest"),
    [(DIAMOND, (), 5), (COUNTED, (8, 4), 7)],
    ids=["diamond", "nested loops"],
)
def test_the_bound_is_what_the_dearest_input_takes(
    tmp_path: Path, chip: Chip, body: str, times: tuple[int, ...], dearest: int
) -> None:
    function = Assembled(tmp_path, body, chip)
    bound = function.bound(*times)
    assert max(function.measured(argument) for argument in range(8)) == bound
    assert function.measured(dearest) == bound


@CHIPS
def test_a_switch_goes_to_all_its_cases(tmp_path: Path, chip: Chip) -> None:
    function = Compiled(tmp_path, SWITCH, chip)
    assert "__tablejump2__" in function.program.symbols
    assert function.bound() == max(function.measured(argument) for argument in range(9))


@CHIPS
def test_no_random_function_is_slower_than_its_bound(tmp_path: Path, chip: Chip) -> None:
    draw = random.Random(11)
    simple = ("nop", "inc r25", "mul r24, r25", "lds r23, 0x200", "adiw r26, 1", "lpm r23, Z")
    for _ in range(3):
        lines = []
        for label in range(10, 40):
            test = draw.choice((f"sbrc r24, {draw.randrange(3)}", f"cpi r24, {draw.randrange(8)}\n  brlo {label}f"))
            lines += [test, draw.choice((*simple, "sts 0x200, r24", "rcall helper")), f"{label}: {draw.choice(simple)}"]
        function = Assembled(tmp_path, "\n  ".join([*lines, "clr r1", "ret"]), chip, also=HELPER)
        bound = function.bound()
        measured = [function.measured(argument) for argument in range(8)]
        assert max(measured) <= bound < 1.5 * max(measured)


@pytest.mark.parametrize(
    ("body", "reason"),
    [
        (COUNTED, "has 2 loops"),
        ("rcall work\n  ret", "recursion"),
        ("ijmp", "through a pointer"),
        ("jmp __tablejump2__\n .global __tablejump2__\n__tablejump2__: ijmp", "whose size cannot be read"),
    ],
)
def test_what_has_no_bound_is_refused(tmp_path: Path, body: str, reason: str) -> None:
    with pytest.raises(ImageError, match=reason):
        Assembled(tmp_path, body, NANO).bound()


def test_what_excludes_each_other_is_not_added(tmp_path: Path) -> None:
    body = "sbrc r24, 0\n  rcall helper\n  sbrs r24, 0\n  rcall other\n  ret"
    function = Assembled(tmp_path, body, NANO, also=HELPER + "other: nop\n  ret")
    apart = Facts({}, {"work": [["call helper", "call other"]]})
    program = function.program
    bound = Timing(program, NANO, apart).of(program.entry("work"))
    assert bound == max(function.measured(argument) for argument in (0, 1)) < function.bound()


KINDS = {"tick's interrupt": 10, "start of the chain": 10, "conversion done": 20, "byte received": 50, "byte sent": 30}


def test_interrupts_add_to_the_tick_as_often_as_they_may_come() -> None:
    bounds = Times(tick=1000, interrupts=KINDS, waking=0)
    assert bounds.response(receiving=False) == 1020 + 2 * 30
    assert bounds.response(receiving=True) == 1080 + (11 + 2) * 50
    longer = Times(tick=3000, interrupts=KINDS, waking=0)
    assert longer.response(receiving=False) == 3080 + 2 * 20
    full = Times(tick=1000, interrupts=KINDS | {"byte received": 161}, waking=0)
    assert full.response(receiving=True) is None
