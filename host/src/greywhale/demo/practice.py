"""What the bench is asked to do before it is tuned: three motions, of which none is shown or judged later."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from pathlib import Path

from greywhale.config import controller as controller_file
from greywhale.config.paper_tables import paper_table
from greywhale.demo.bench import BenchProcess
from greywhale.demo.recorder import record_motion
from greywhale.identify.controllers import Table
from greywhale.log import Log
from greywhale.trajectory import human_reaches, save_leader

Progress = Callable[[str, float], None]

UNTUNED, OTHER = "before_tuning", "table_9"  # of the paper: where tuning starts, and the changed controller


@dataclass(frozen=True)
class Practice:
    """Generated reaches, with one of the paper's controllers; `share` of the length of the one to fit."""

    name: str
    share: float
    controller: str


# To fit; to validate; to validate with another controller: was the arm learnt, or the arm with its controller?
PRACTICE = (
    Practice("practice", 1.0, UNTUNED),
    Practice("check", 0.4, UNTUNED),
    Practice("check_changed", 0.4, OTHER),
)
PRACTICE_S = 30.0
FIRST_SEED = 1000  # far from those that people give


def practise(
    bench: BenchProcess, folder: Path, seconds: float = PRACTICE_S, progress: Progress | None = None
) -> list[Log]:
    """Record every practice into `folder`: the log to fit, of about `seconds`, then those to validate."""
    report = progress or (lambda what, fraction: None)
    logs = []
    for number, practice in enumerate(PRACTICE):
        leader = folder / f"{practice.name}_leader.csv"
        save_leader(leader, human_reaches(FIRST_SEED + number, practice.share * seconds))

        def told(what: str, fraction: float, name: str = practice.name) -> None:
            report(f"{name}: {what}", fraction)

        log = folder / f"{practice.name}.csv"
        logs.append(record_motion(bench, leader, log, paper_table(practice.controller), told).log())
    return logs


def tables(base: Sequence[int]) -> list[Table]:
    """The parameters of the practice's logs: its controllers on a board that otherwise has `base`."""
    found = []
    for name in (UNTUNED, OTHER):
        raw = controller_file.load(paper_table(name)).raw_values()
        found.append(Table(name, tuple(raw.get(index, value) for index, value in enumerate(base))))
    return found
