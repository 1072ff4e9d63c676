"""The deepest that a firmware's stack can get: the longest path through the call graph and the deepest interrupt."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from pathlib import Path

from elftools.elf.elffile import ELFFile

from tools.gates.image import TABLE_JUMP, Function, GateError, read_image

DATA_SPACE = 0x800000


@dataclass(frozen=True)
class Chip:
    """Where RAM ends, and how many bytes a return address takes."""

    name: str
    ram_end: int
    return_address: int


MEGA = Chip("ATmega2560", 0x21FF, 3)
NANO = Chip("ATmega328P", 0x08FF, 2)


@dataclass(frozen=True)
class Bound:
    """Bytes of stack at most, the path that needs them, and the RAM that variables leave."""

    bytes: int
    path: tuple[str, ...]
    interrupt: str
    free: int


class Depths:
    """Depth of every function, its own return address not counted."""

    def __init__(self, functions: Mapping[str, Function], chip: Chip) -> None:
        self._functions, self._chip = functions, chip
        self._known: dict[str, tuple[int, tuple[str, ...]]] = {}
        self._open: list[tuple[str, bool]] = []  # the path down to here, and whether each was entered by a jump

    def of(self, name: str, by_jump: bool = False) -> tuple[int, tuple[str, ...]]:
        """The depth, and the path that reaches it."""
        if name in self._known:
            return self._known[name]
        if any(name == entered for entered, _ in self._open):
            self._must_be_a_loop(name, by_jump)
            return 0, ()
        function = self._functions[name]
        if function.indirect and name != TABLE_JUMP:
            raise GateError(f"{name} calls through a pointer; the gate cannot tell whom, so avoid it.")
        self._open.append((name, by_jump))
        paths: list[tuple[int, tuple[str, ...]]] = [(0, ())]
        for callee in sorted(function.calls):
            depth, path = self.of(callee)
            paths.append((self._chip.return_address + depth, path))
        paths += [self.of(target, by_jump=True) for target in sorted(function.jumps - {name})]
        self._open.pop()
        deepest, path = max(paths)
        self._known[name] = (function.pushes + function.frame + deepest, (name, *path))
        return self._known[name]

    def _must_be_a_loop(self, name: str, by_jump: bool) -> None:
        """Parts of one assembly function may jump in circles; anything else that comes back to itself is recursion."""
        names = [entered for entered, _ in self._open]
        circle = self._open[names.index(name) :]
        jumps = by_jump and all(jump for _, jump in circle[1:])
        if not jumps or any(self._functions[entered].pushes for entered, _ in circle):
            raise GateError(f"{' -> '.join([*names, name])}: recursion, so the stack has no bound.")


def bound(elf: Path, chip: Chip) -> Bound:
    """The bound of an image that starts at main; interrupts do not nest unless one enables them."""
    functions = read_image(elf)
    depths = Depths(functions, chip)
    starts = [name for name in ("main", "__do_global_ctors") if name in functions]
    foreground, path = max(depths.of(name) for name in starts)
    vectors = {name: depths.of(name)[0] for name in functions if name.startswith("__vector_") and name[9:].isdigit()}
    if nesting := [name for name in vectors if functions[name].enables]:
        raise GateError(
            f"{', '.join(nesting)}: an interrupt that enables interrupts may nest, so the stack has no bound."
        )
    interrupt = max(vectors, key=lambda name: vectors[name], default="")
    extra = chip.return_address + vectors[interrupt] if interrupt else 0
    return Bound(chip.return_address + foreground + extra, path, interrupt, chip.ram_end + 1 - _variables_end(elf))


def _variables_end(elf: Path) -> int:
    with elf.open("rb") as stream:
        sections = [
            s for s in ELFFile(stream).iter_sections() if s.name in (".data", ".bss", ".noinit") and s["sh_size"]
        ]
        return max(int(section["sh_addr"] + section["sh_size"]) for section in sections) - DATA_SPACE
