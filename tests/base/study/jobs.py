"""Functions that the tests' studies do, in a module that other processes can import."""

from __future__ import annotations

import os
import signal
from pathlib import Path
from typing import Any

import numpy as np

from greywhale.base.errors import UserError
from greywhale.base.study import Task


def draw(seed: int, count: int) -> dict[str, Any]:
    """Numbers of every kind, some of which no other order of sums would give."""
    values = np.random.default_rng(seed).normal(size=(count, 3))
    return {
        "values": values,
        "sums": [float(one) for one in (values @ values.T).sum(axis=0)],
        "odd": (float("inf"), float("nan"), -0.0, 5e-324),
        "of": f"seed {seed}",
    }


def draws(number: int) -> list[Task]:
    return [Task(f"draw {seed}", draw, seed, {"count": 40 + seed}) for seed in range(number)]


def note(seed: int, folder: str) -> int:
    """Leaves a line for every time that it was done."""
    with (Path(folder) / "done").open("a") as file:
        file.write(f"{seed}\n")
    return seed * seed


def notes(number: int, folder: Path) -> list[Task]:
    return [Task(f"note {seed}", note, seed, {"folder": str(folder)}) for seed in range(number)]


def done(folder: Path) -> list[int]:
    """The seeds of all notes that were taken."""
    path = folder / "done"
    return sorted(int(line) for line in path.read_text().split()) if path.exists() else []


def die_first(seed: int, folder: str) -> int:
    """The first time its worker is killed."""
    path = Path(folder) / "died"
    if not path.exists():
        path.touch()
        os.kill(os.getpid(), signal.SIGKILL)
    return seed


def fail(seed: int) -> None:
    raise KeyError(f"seed {seed}")


def leave(seed: int) -> None:
    raise SystemExit(3)


def refuse(seed: int) -> None:
    raise UserError(f"seed {seed} is refused.", 2)


def strange(seed: int) -> object:
    return object()
