"""Code for one instruction set never runs in place of another's, on a processor that may lack it."""

from __future__ import annotations

import json
import re
import subprocess
from pathlib import Path

from greywhale import _native

BUILD = Path(__file__).parents[2] / "build" / "extensions"


def objects() -> dict[Path, str]:
    """All objects of the native library with their instruction set, or "" for those that every processor runs."""
    commands = json.loads((BUILD / "compile_commands.json").read_text(encoding="utf-8"))
    found = {}
    for command in commands:
        instructions = re.search(r"-DGREYWHALE_INSTRUCTIONS=(\w+)", command["command"])
        found[BUILD / command["output"]] = instructions[1] if instructions else ""
    return found


def outsiders(path: Path, namespace: str) -> list[str]:
    """Symbols that the linker may take for another object's: those whose mangled name does not hold the namespace."""
    table = subprocess.run(
        ["nm", "--defined-only", "--extern-only", "--just-symbols", str(path)],
        check=True,
        capture_output=True,
        text=True,
    ).stdout.split()
    assert table, path
    return [symbol for symbol in table if f"{len(namespace)}{namespace}" not in symbol]


def test_every_symbol_of_a_kernel_is_in_its_own_namespace() -> None:
    kernels = {path: instructions for path, instructions in objects().items() if instructions}
    assert set(kernels.values()) >= set(_native.instruction_sets())
    for path, instructions in kernels.items():
        assert outsiders(path, instructions) == [], path


def test_wide_instructions_are_asked_for_by_kernels_only() -> None:
    commands = json.loads((BUILD / "compile_commands.json").read_text(encoding="utf-8"))
    for command in commands:
        wide = re.findall(r"-m(?:avx\w*|fma|arch=\S+)", command["command"])
        if "GREYWHALE_INSTRUCTIONS=avx" not in command["command"]:
            assert wide == [], command["file"]
        assert "-ffp-contract=off" in command["command"] or "nanobind" in command["file"], command["file"]
