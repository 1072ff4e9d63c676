"""The gates on small programs made to break them; on the real images `make gates` runs them."""

from __future__ import annotations

import subprocess
from pathlib import Path

import pytest

from greywhale._native import Board
from greywhale_sim.programs import load_elf
from tools import avr_tool
from tools.gates import apply, size, stack, tick
from tools.gates.timing.cycles import MEGA, NANO, Chip
from tools.gates.timing.listing import ImageError, read_program

TICK = "void firmware_tick()"
FRAME = """
#include <avr/interrupt.h>
#include <avr/sleep.h>
#include <stdint.h>
#include <stdlib.h>
volatile uint16_t a = 1000, b = 7;
volatile float f = 1.5f;
volatile uint8_t sink;
extern "C" void firmware_tick() __attribute__((noinline));
{program}
int main() {{
  firmware_tick();
  cli();
  sleep_enable();
  sleep_cpu();
}}
"""


def build(folder: Path, program: str, chip: str = "atmega328p") -> Path:
    source, elf = folder / "program.cpp", folder / "program.elf"
    source.write_text(FRAME.format(program=program))
    subprocess.run(
        [avr_tool("avr-g++"), "-std=gnu++14", "-O2", f"-mmcu={chip}", str(source), "-o", str(elf)], check=True
    )
    return elf


def test_a_division_is_found_in_interrupts_and_deep_below_a_tick(tmp_path: Path) -> None:
    deep = "__attribute__((noinline)) void deep() { a = a / b; }"
    mid = "__attribute__((noinline)) void mid() { deep(); sink = 1; }"
    below = build(tmp_path, f"{deep} {mid} void firmware_tick() {{ mid(); sink = 2; }}")
    assert any("mid" in complaint and "deep" in complaint for complaint in tick.complaints(read_program(below)))
    interrupt = build(tmp_path, "ISR(TIMER0_COMPA_vect) { a = a / b; } void firmware_tick() {}")
    assert "__vector_14" in tick.complaints(read_program(interrupt))[0]


def test_a_heap_a_float_or_too_much_is_found_anywhere_in_an_image(tmp_path: Path) -> None:
    program = "__attribute__((used)) void elsewhere() { f = f * (uintptr_t)malloc(b); } void firmware_tick() {}"
    assert {"malloc: a heap is linked in.", "__mulsf3: floating point is linked in."} <= set(
        size.complaints(build(tmp_path, program))
    )
    large = f"volatile uint8_t room[{size.RAM_LIMIT + 1}]; void firmware_tick() {{ sink = room[b]; }}"
    complaints = size.complaints(build(tmp_path, large))
    assert any(f"bytes of RAM, but {size.RAM_LIMIT} is the limit" in one for one in complaints)


DEEP = """
__attribute__((noinline)) uint8_t leaf(uint8_t n) {{
  volatile uint8_t room[{leaf}];
  for (uint8_t i = 0; i < sizeof room; ++i) room[i] = n;
  return room[n];
}}
__attribute__((noinline)) uint8_t middle(uint8_t n) {{
  volatile uint8_t room[{middle}];
  for (uint16_t i = 0; i < sizeof room; ++i) room[i] = leaf(n);
  return room[n];
}}
void firmware_tick() {{ sink = middle(3); }}
"""


@pytest.mark.parametrize(("chip", "kind", "ram"), [("atmega328p", NANO, 0x100), ("atmega2560", MEGA, 0x200)])
@pytest.mark.parametrize(("leaf", "middle"), [(5, 20), (60, 64), (100, 300)])
def test_the_stack_bound_holds_and_is_tight(
    tmp_path: Path, chip: str, kind: Chip, ram: int, leaf: int, middle: int
) -> None:
    elf = build(tmp_path, DEEP.format(leaf=leaf, middle=middle), chip)
    bound = stack.bound(elf, kind)
    board = Board(chip)
    load_elf(board, elf)
    board.power_on(1)
    board.poke(ram, bytes([0xA5]) * (kind.ram_end + 1 - ram))
    assert board.run_until(10_000_000) == 1
    memory = board.peek(ram, kind.ram_end + 1 - ram)
    first = next(i for i in range(0x100, len(memory)) if memory[i] != 0xA5)
    deepest = len(memory) - first
    assert deepest <= bound.bytes <= deepest + 16
    assert bound.free == kind.ram_end + 1 - ram - 9 or bound.free > 1000


@pytest.mark.parametrize(
    ("program", "reason"),
    [
        (f"uint16_t down(uint16_t n) {{ return n ? down(n - 1) + a : 0; }} {TICK} {{ a = down(b); }}", "recursion"),
        (f"void (*volatile whom)(); {TICK} {{ whom(); sink = 1; }}", "through a pointer"),
        (f"ISR(TIMER0_COMPA_vect) {{ sei(); sink = 1; }} {TICK} {{}}", "may nest"),
    ],
)  # fmt: skip
def test_what_cannot_be_bounded_is_refused(tmp_path: Path, program: str, reason: str) -> None:
    program = program.replace("uint16_t down", "__attribute__((noinline, optimize(0))) uint16_t down")
    with pytest.raises(ImageError, match=reason):
        stack.bound(build(tmp_path, program), NANO)


def test_a_slow_step_and_late_ticks_are_told_apart_each_with_its_step_and_its_numbers() -> None:
    cycles = {"crc": 9_000, "joint 2": 21_000, "finish": 8_000}
    assert apply.complaints(apply.Applied(cycles, late_ticks=0)) == []
    (late,) = apply.complaints(apply.Applied(cycles, late_ticks=3))
    assert "6 sets has made 3 ticks late; the longest step, `joint 2`, takes 21000 cycles" in late
    (slow,) = apply.complaints(apply.Applied(cycles | {"finish": apply.LIMIT + 1}, late_ticks=0))
    assert "the step `finish` of applying a set takes 48001 cycles" in slow
