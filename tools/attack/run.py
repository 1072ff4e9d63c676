"""Runs a part of the attacks as a study: its pieces in processes, in a file from which an interrupted run goes on."""

from __future__ import annotations

import json
import time
from collections.abc import Callable
from dataclasses import asdict, dataclass
from pathlib import Path
from typing import Any

from greywhale.base.study import Task, choose_workers, run_study
from tools.attack import parts
from tools.attack.part import Part, Row, add_up
from tools.setup import stamps


@dataclass(frozen=True)
class Result:
    """The rows that all pieces of a part came to, and how long one process would have taken."""

    part: Part
    rows: list[Row]
    seconds: float


def digest(part: Part) -> str:
    """Of all that a part's result is about."""
    return stamps.digest(stamps.files_below(*part.depends, f"tools/attack/parts/{part.name}.py"))[:16]


def attack(
    part: Part, share: float, workers: int | None, folder: Path, progress: Callable[[str, float], None] | None = None
) -> Result:
    """Do what is missing of a share of a part; another state of the code has another file."""
    folder.mkdir(parents=True, exist_ok=True)
    tasks = [
        Task(json.dumps(piece), do_piece, piece["seed"], {"part": part.name, "piece": piece})
        for piece in part.pieces(share)
    ]
    path = folder / f"{part.name}-{share:g}-{digest(part)}.study"
    found = run_study(tasks, choose_workers(workers), path, progress, what=part.title).values()
    rows = add_up(Row(**row) for piece in found for row in piece["rows"])
    return Result(part, rows, sum(piece["seconds"] for piece in found))


def do_piece(seed: int, part: str, piece: dict[str, Any]) -> dict[str, Any]:
    """In a worker: the rows of a piece, and how long it took."""
    began = time.monotonic()
    rows = next(one for one in parts.PARTS if one.name == part).run(piece)
    return {"rows": [asdict(row) for row in add_up(rows)], "seconds": round(time.monotonic() - began, 1)}
