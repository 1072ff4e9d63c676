"""Keeps the simulated EEPROM in a file, so that saved parameters outlive the bench as they outlive a real
board's power.
"""

from __future__ import annotations

from pathlib import Path
from typing import IO

from greywhale.base.errors import UserError, os_reason
from greywhale.base.formats.whole import write_whole


def load(path: Path, size: int) -> bytes | None:
    """The content of the file, or None where there is none yet (a factory-new chip)."""
    try:
        data = path.read_bytes()
    except FileNotFoundError:
        return None
    except OSError as error:
        raise UserError(f"{path}: the EEPROM file cannot be read: {os_reason(error)}.") from None
    if len(data) != size:
        raise UserError(
            f"{path}: has {len(data)} bytes, but this board's EEPROM has {size}; "
            "name another file or delete this one to start with an empty EEPROM."
        )
    return data


def save(path: Path, data: bytes) -> None:
    """Replace the file whole or not at all."""
    write_whole(path, lambda file: _write(file, data))


def _write(file: IO[bytes], data: bytes) -> None:
    file.write(data)
