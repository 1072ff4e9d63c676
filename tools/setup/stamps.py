"""Remembers what each step was done for, so that a step runs again only when its inputs have changed."""

from __future__ import annotations

import hashlib
import shutil
from collections.abc import Iterable
from pathlib import Path

from tools import ROOT

STAMPS = ROOT / "build" / "stamps"
SKIPPED = {"__pycache__", ".pio", ".pytest_cache", "node_modules"}
GENERATED = {".pyc", ".pyi"}


def files_below(*places: str) -> list[Path]:
    """Every source file of the given files and folders of the repository."""
    found: list[Path] = []
    for place in places:
        path = ROOT / place
        candidates = path.rglob("*") if path.is_dir() else [path]
        found += [p for p in candidates if p.is_file() and not SKIPPED & set(p.parts) and p.suffix not in GENERATED]
    return sorted(found)


def digest(files: Iterable[Path], *words: str) -> str:
    """One number for names and contents of files, and for further words a step depends on."""
    total = hashlib.sha256(repr(words).encode())
    for path in files:
        content = hashlib.sha256(path.read_bytes()).hexdigest()
        total.update(f"{path.relative_to(ROOT)} {content}\n".encode())
    return total.hexdigest()


def forget(step: str = "") -> None:
    """The step is not done; without a name, none is."""
    if step:
        (STAMPS / step).unlink(missing_ok=True)
    else:
        shutil.rmtree(STAMPS, ignore_errors=True)


def is_current(step: str, value: str, strict: bool = False) -> bool:
    """True if the step was done for this value; what was done strictly serves others, too."""
    stamp = STAMPS / step
    return stamp.is_file() and stamp.read_text() in {f"{value} strict", *(() if strict else (value,))}


def set_current(step: str, value: str, strict: bool = False) -> None:
    STAMPS.mkdir(parents=True, exist_ok=True)
    (STAMPS / step).write_text(f"{value} strict" if strict else value)
