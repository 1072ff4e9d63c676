"""Functions that the tests' studies do, in a module that other processes can import."""

from __future__ import annotations

import os
import signal
import threading
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


def hang_first(seed: int, folder: str, count: int) -> dict[str, Any]:
    """The first time it tells who has it, through the pipe `who`, and never ends."""
    try:
        os.close(os.open(Path(folder) / "first", os.O_CREAT | os.O_EXCL))
    except FileExistsError:
        return draw(seed, count)
    (Path(folder) / "who").write_text(f"{os.getpid()}\n")
    threading.Event().wait()
    raise AssertionError("nothing sets the event")


def kill_who_hangs(folder: Path) -> threading.Thread:
    """Make the pipe `who`, and kill whoever writes there. The thread ends then."""
    pipe = folder / "who"
    os.mkfifo(pipe)

    def kill() -> None:
        process = int(pipe.read_text())
        (folder / "killed").write_text(str(process))
        os.kill(process, signal.SIGKILL)

    thread = threading.Thread(target=kill)
    thread.start()
    return thread


def killed(folder: Path) -> int:
    """Who was killed."""
    return int((folder / "killed").read_text())


def die(seed: int) -> None:
    os.kill(os.getpid(), signal.SIGKILL)


def fail(seed: int) -> None:
    raise KeyError(f"seed {seed}")


def leave(seed: int) -> None:
    raise SystemExit(3)


def refuse(seed: int) -> None:
    raise UserError(f"seed {seed} is refused.", 2)


def strange(seed: int) -> object:
    return object()
