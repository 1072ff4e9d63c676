"""The instructions and names of an AVR image, read from avr-objdump's disassembly."""

from __future__ import annotations

import re
import subprocess
from bisect import bisect_right
from collections.abc import Mapping
from dataclasses import dataclass
from functools import cached_property
from pathlib import Path

from tools import avr_tool

SYMBOL = re.compile(r"^([0-9a-f]{8}) <(.+)>:$")
INSTRUCTION = re.compile(r"^\s+([0-9a-f]+):\t((?:[0-9a-f]{2} )+)\s*\t(\S+)\s*([^;]*)(?:;\s*0x([0-9a-f]+))?")
BRANCHES = {
    "brcc", "brcs", "breq", "brge", "brhc", "brhs", "brid", "brie", "brlo",
    "brlt", "brmi", "brne", "brpl", "brsh", "brtc", "brts", "brvc", "brvs",
}  # fmt: skip
SKIPS = {"cpse", "sbrc", "sbrs", "sbic", "sbis"}
CALLS = {"call", "rcall"}
JUMPS = {"jmp", "rjmp"}
RETURNS = {"ret", "reti"}
THROUGH_POINTER = {"ijmp", "eijmp", "icall", "eicall"}


class ImageError(Exception):
    """The image holds something that cannot be judged as it is."""


@dataclass(frozen=True)
class Instruction:
    """One instruction; address and size in bytes, target the byte address that it may go to."""

    address: int
    size: int
    mnemonic: str
    operands: str
    target: int | None
    code: bytes

    @property
    def next(self) -> int:
        return self.address + self.size


@dataclass(frozen=True)
class Program:
    """A whole image. Data tables in flash are there as nonsense instructions that nothing reaches."""

    instructions: Mapping[int, Instruction]
    symbols: Mapping[str, int]

    @cached_property
    def _places(self) -> tuple[list[int], list[str]]:
        order = sorted(self.symbols, key=lambda name: self.symbols[name])
        return [self.symbols[name] for name in order], order

    @cached_property
    def _flash(self) -> dict[int, int]:
        return {i.address + n: byte for i in self.instructions.values() for n, byte in enumerate(i.code)}

    @cached_property
    def vectors(self) -> dict[int, int]:
        """Number -> address of every interrupt handler."""
        found = {name.removeprefix("__vector_"): address for name, address in self.symbols.items()}
        return {int(name): address for name, address in found.items() if name.isdigit()}

    def word(self, address: int) -> int:
        """The 16-bit number at a byte address of the flash."""
        return self._flash[address] | self._flash[address + 1] << 8

    def at(self, address: int) -> Instruction:
        try:
            return self.instructions[address]
        except KeyError:
            raise ImageError(f"{self.name(address)} goes to {address:#x}, where no instruction begins.") from None

    def name(self, address: int) -> str:
        """The symbol that an address belongs to, as a reader knows it: see plain_name()."""
        return plain_name(self.symbol(address))

    def symbol(self, address: int) -> str:
        starts, names = self._places
        place = bisect_right(starts, address)
        return names[place - 1] if place else "?"

    def entry(self, name: str) -> int:
        """The address at which the function of this plain name begins."""
        found = [address for symbol, address in self.symbols.items() if name in (symbol, plain_name(symbol))]
        if not found:
            raise ImageError(f"{name} is not in the image: was it renamed or inlined?")
        return min(found)


_PLAIN: dict[str, str] = {}


def plain_name(symbol: str) -> str:
    """A C++ name without arguments and without the compiler's suffixes, which differ from build to build."""
    if symbol not in _PLAIN:
        _demangle([symbol])
    return _PLAIN[symbol]


def _demangle(symbols: list[str]) -> None:
    stems = [re.sub(r"\.(constprop|isra|part|lto_priv|cold)\b.*", "", symbol) for symbol in symbols]
    output = subprocess.run(["avr-c++filt"], input="\n".join(stems), check=True, capture_output=True, text=True).stdout
    for symbol, name in zip(symbols, output.splitlines(), strict=True):
        plain = name.replace("(anonymous namespace)::", "").split("(")[0]
        _PLAIN[symbol] = plain.split(" ")[-1] if "<" not in plain else plain


def _target(address: int, mnemonic: str, operands: str) -> int | None:
    if mnemonic in ("call", "jmp"):
        return int(operands.split()[0], 16)
    if mnemonic in ("rcall", "rjmp") or mnemonic in BRANCHES:
        return address + 2 + int(operands.split()[0].removeprefix("."))
    return None


def parse(text: str) -> Program:
    """The program of a listing as avr-objdump -d prints it."""
    instructions: dict[int, Instruction] = {}
    symbols: dict[str, int] = {}
    for row in text.splitlines():
        if head := SYMBOL.match(row):
            symbols[head[2]] = int(head[1], 16)
        elif found := INSTRUCTION.match(row):
            address, code = int(found[1], 16), bytes.fromhex(found[2])
            mnemonic, operands = found[3], found[4].strip()
            target = _target(address, mnemonic, operands)
            instructions[address] = Instruction(address, len(code), mnemonic, operands, target, code)
    _demangle(list(symbols))
    return Program(instructions, symbols)


def read_program(elf: Path) -> Program:
    run = subprocess.run([avr_tool("avr-objdump"), "-d", "-z", str(elf)], check=True, capture_output=True, text=True)
    return parse(run.stdout)
