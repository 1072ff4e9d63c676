"""The whole study: every record by halves, records against other records, and `greywhale identify` itself."""

from __future__ import annotations

import os
from collections.abc import Iterator
from dataclasses import dataclass
from pathlib import Path

from greywhale.base.errors import FAILED, UserError
from studies.real_data.compare import Comparison, across, halves, loop_error, window_error
from studies.real_data.product import identified, shortened
from studies.real_data.rigs import COLLECTIONS, Source
from tools import ROOT

VARIABLE = "GREYWHALE_REAL_DATA"
# Fitted to the first, judged on the second: another controller, or another motion.
ACROSS: tuple[tuple[tuple[str, ...], tuple[str, ...]], ...] = (
    (("pid_step",), ("pr",)),
    (("pr",), ("pid_step",)),
    (("kp200_sin_sin", "kp200_up_and_down"), ("kp400_sin_sin", "kp400_up_and_down")),
    (("kp200_up_and_down", "kp400_up_and_down"), ("kp200_sin_sin", "kp400_sin_sin")),
    (("a_free_motion",), ("b_free_motion", "c_free_motion")),
    (("c_free_motion",), ("a_free_motion", "b_free_motion")),
)
# What `greywhale identify` is given and what it is judged on; where both are one, by halves. It asks for 4 s of log.
PRODUCT = (
    ("pid_step", "pid_step"),
    ("relay_method", "relay_method"),
    ("kp200_sin_sin", "kp400_sin_sin"),
    ("kp400_sin_sin", "kp200_sin_sin"),
    ("a_free_motion", "c_free_motion"),
    ("c_free_motion", "a_free_motion"),
    ("kp200_up_and_down", "kp400_up_and_down"),
)


@dataclass(frozen=True)
class ProductScore:
    """`greywhale identify` on one record, its model judged on another."""

    fitted: str
    judged: str
    loop: float
    windows: float


def data_folder() -> Path:
    """Where the recordings are: the environment variable, or shared/data beside the project."""
    folder = Path(os.environ.get(VARIABLE) or ROOT.parent / "shared" / "data")
    if not folder.is_dir():
        raise UserError(
            f"{folder} is not there, so there are no recordings to compare with; set {VARIABLE} to the folder that "
            f"holds {', '.join(one.folder for one in COLLECTIONS)} (docs/real_data.md says where they come from).",
            FAILED,
        )
    return folder


def read_sources(folder: Path) -> dict[str, Source]:
    """Every record by its name."""
    sources = [one.read(folder / one.folder / file) for one in COLLECTIONS for file in one.files]
    return {source.record.name: source for source in sources}


def by_halves(sources: dict[str, Source]) -> Iterator[Comparison]:
    for source in sources.values():
        yield halves(source)


def by_records(sources: dict[str, Source]) -> Iterator[Comparison]:
    for fitted, judged in ACROSS:
        yield across([sources[name] for name in fitted], [sources[name] for name in judged])


def by_product(sources: dict[str, Source]) -> Iterator[ProductScore]:
    for fitted, judged in PRODUCT:
        source, target = sources[fitted], sources[judged]
        same = fitted == judged
        plant = identified(shortened(source) if same else source)
        begin = target.record.middle if same else 0
        yield ProductScore(fitted, judged, loop_error(target, plant, begin), window_error(target, plant, begin))
