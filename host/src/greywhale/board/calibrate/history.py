"""The calibrations that a board has had: a folder for each board, a parameter file for each calibration.

A file is written once and never again. Its name says which it is, when and why it was written; whoever adds one holds
a lock on the folder, so that two programs at once give them two numbers.
"""

from __future__ import annotations

import logging
import re
from collections.abc import Iterator, Mapping
from contextlib import contextmanager
from dataclasses import dataclass
from datetime import UTC, datetime
from pathlib import Path

from greywhale.base import system
from greywhale.base.errors import BadUsage, UserError, os_reason
from greywhale.base.formats.whole import make_folder
from greywhale.base.state import VARIABLE, state_directory
from greywhale.board.pots import POTS
from greywhale.files import parameter_file
from greywhale.protocol.firmware import JOINTS
from greywhale.protocol.ports import lasting_label
from greywhale.protocol.table import ParameterTable

logger = logging.getLogger(__name__)

FOUND = "found"  # why: the board had it, and nobody knows from where
# The parameters of a calibration; whoever goes back to an earlier one leaves all others as they are.
NAMES = (
    *(f"{pot}.{key}" for pot in POTS for key in ("zero", "scale")),
    *(f"joint{joint}.{key}" for joint in range(JOINTS) for key in ("limit_min", "limit_max", "motor_sign")),
)
_FILE = re.compile(r"(\d{4,9})-(\d{8}T\d{6})Z-([a-z-]+)\.toml", re.ASCII)
_TIME = "%Y%m%dT%H%M%S"


@dataclass(frozen=True)
class Kept:
    """A calibration that was kept: its number, counted from 1; when (UTC) and why; its file, with all parameters."""

    number: int
    when: datetime
    why: str
    path: Path

    def values(self) -> dict[str, int]:
        """Raw values by name, of a calibration alone. Raises UserError where somebody has damaged the file."""
        stated = parameter_file.load_stated(self.path)
        return {name: stated[name] for name in NAMES}


def folder_of(port: str) -> Path:
    """The folder of the board at a port."""
    return state_directory() / "calibrations" / lasting_label(port)


def calibration_of(table: ParameterTable) -> dict[str, int]:
    """The calibration in a table: raw values by name."""
    return {name: table[name] for name in NAMES}


def kept(folder: Path) -> list[Kept]:
    """The calibrations in a folder, the oldest first; none where there is no folder."""
    try:
        names = sorted(path.name for path in folder.iterdir()) if folder.is_dir() else []
        return sorted(filter(None, (_kept(folder / name) for name in names)), key=lambda one: one.number)
    except OSError as error:
        raise UserError(f"{folder}: cannot be read: {os_reason(error)}.") from None


def find(folder: Path, number: int) -> Kept:
    """The calibration of this number. Raises BadUsage where there is none."""
    found = kept(folder)
    for one in found:
        if one.number == number:
            return one
    there = f"there are {found[0].number} to {found[-1].number}" if found else "none was kept yet"
    raise BadUsage(f"there is no calibration {number} of this board; {there}.")


def keep(folder: Path, table: ParameterTable, why: str, now: datetime | None = None) -> Kept | None:
    """Keep the calibration of a table unless the newest is the same; None where it is. `now` is the time, UTC.

    Raises UserError where it cannot be written; then nothing is left.
    """
    make_folder(folder)
    with _alone(folder):
        before = kept(folder)
        if before and _is_same(before[-1], calibration_of(table)):
            return None
        number = before[-1].number + 1 if before else 1
        when = (now or datetime.now(UTC)).replace(microsecond=0)
        path = folder / f"{number:04d}-{when.strftime(_TIME)}Z-{why}.toml"
        parameter_file.save(path, table)
        return Kept(number, when, why, path)


@contextmanager
def keeping(port: str, before: ParameterTable, after: ParameterTable, why: str) -> Iterator[None]:
    """Keep both around what gives the board `after`: the one before it, even if it fails. Nothing where the calibration
    stays.
    """
    changes = calibration_of(before) != calibration_of(after)
    kept_before = changes and try_to_keep(port, before, FOUND)
    yield
    if kept_before:
        try_to_keep(port, after, why)


def try_to_keep(port: str, table: ParameterTable, why: str) -> bool:
    """Keep the calibration of the board at a port; a history that cannot be written is a warning, and False."""
    try:
        keep(folder_of(port), table, why)
    except UserError as error:
        logger.warning("%s This calibration is not in the history; %s names another folder.", error.message, VARIABLE)
        return False
    return True


def _kept(path: Path) -> Kept | None:
    """None for a file of another name."""
    if (match := _FILE.fullmatch(path.name)) is None:
        return None
    try:
        when = datetime.strptime(match[2], _TIME).replace(tzinfo=UTC)
    except ValueError:
        return None
    return Kept(int(match[1]), when, match[3], path)


def _is_same(newest: Kept, values: Mapping[str, int]) -> bool:
    """False for a file that somebody has damaged: the next one says it again."""
    try:
        return newest.values() == values
    except UserError:
        return False


@contextmanager
def _alone(folder: Path) -> Iterator[None]:
    """Hold the folder against other programs."""
    try:
        file = (folder / ".lock").open("ab")
    except OSError as error:
        raise UserError(f"{folder}: cannot be written: {os_reason(error)}.") from None
    with file:
        try:
            system.lock(file.fileno(), wait=True)
        except OSError as error:
            raise UserError(f"{folder}: cannot be locked: {os_reason(error)}.") from None
        yield
