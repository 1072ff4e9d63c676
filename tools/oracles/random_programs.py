"""Programs that nobody here wrote: csmith makes them up, avr-gcc compiles them for both chips."""

from __future__ import annotations

import subprocess
from dataclasses import dataclass
from pathlib import Path

# Small enough for 2 kB of RAM; a bit field of more than 16 bits does not compile where int has no more.
CSMITH = (
    *("--no-argc", "--concise", "--max-funcs", "5", "--max-block-depth", "3", "--max-struct-fields", "4"),
    *("--no-bitfields", "--max-array-dim", "2", "--max-array-len-per-dim", "4"),
)
RAM = {"atmega2560": (0x200, 0x2200), "atmega328p": (0x100, 0x900)}  # its first address and its end
LEVELS = ("-Os", "-O2")
STACK_BYTES = 512
# The end of the program is a SLEEP with interrupts off, which each simulator can see.
ENDING = """
#include <avr/io.h>
#include <avr/interrupt.h>
#include <avr/sleep.h>
int made_up(void);
int main(void) { made_up(); cli(); sleep_enable(); for (;;) sleep_cpu(); }
"""


@dataclass(frozen=True)
class RandomProgram:
    """One program as an Intel HEX file."""

    seed: int
    chip: str
    level: str
    hex: Path


def make_program(seed: int, chip: str, level: str, folder: Path, compiler: str = "avr-gcc") -> RandomProgram | None:
    """The program of a seed; None if its variables leave no room for a stack on this chip."""
    source, ending = folder / f"{seed}.c", folder / "ending.c"
    elf = folder / f"{seed}-{chip}{level}.elf"
    if not source.exists():
        # It also leaves a file about the machine in the current folder.
        subprocess.run(["csmith", "--seed", str(seed), *CSMITH, "--output", source.name], cwd=folder, check=True)
    ending.write_text(ENDING)
    flags = [f"-mmcu={chip}", level, "-w"]
    made_up = source.with_name(f"{seed}-{chip}{level}.o")
    _run(
        compiler, *flags, "-DAVR_ARCH", "-Dmain=made_up", "-isystem", "/usr/include/csmith", "-c", "-o", made_up, source
    )
    _run(compiler, *flags, "-o", elf, made_up, ending)
    sizes = _run("avr-size", elf).splitlines()[1].split()  # text, data, bss
    first, end = RAM[chip]
    if int(sizes[1]) + int(sizes[2]) > end - first - STACK_BYTES:
        return None
    _run("avr-objcopy", "-O", "ihex", "-j", ".text", "-j", ".data", elf, elf.with_suffix(".hex"))
    return RandomProgram(seed, chip, level, elf.with_suffix(".hex"))


def _run(*command: str | Path) -> str:
    return subprocess.run(list(map(str, command)), check=True, capture_output=True, text=True).stdout
