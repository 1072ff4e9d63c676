"""Add inputs to a fuzzer's corpus and keep the smallest ones that reach all that is reached.

python -m tools.attack.corpus app|frames|table [FOLDER ...]
"""

from __future__ import annotations

import subprocess
import sys
import tempfile
import zipfile
from collections.abc import Sequence
from pathlib import Path

from tools.attack.native import build
from tools.attack.parts.fuzz import CORPUS, LIMITS, TARGETS, unpack

WHEN = (1980, 1, 1, 0, 0, 0)  # of every entry, so that equal inputs make an equal file


def minimise(target: str, folders: Sequence[Path], kept: Path) -> None:
    """Fill a folder. An input is kept when it reaches an edge of the code that no smaller one reaches."""
    command = [str(build(TARGETS[target])), *LIMITS, "-merge=1", "-use_counters=0", str(kept), *map(str, folders)]
    subprocess.run(command, stderr=subprocess.DEVNULL, check=True)


def pack(target: str, folder: Path) -> int:
    """Write the packed corpus from a folder's files, named in the order of their size."""
    inputs = sorted((file.read_bytes() for file in folder.iterdir()), key=lambda data: (len(data), data))
    CORPUS.mkdir(exist_ok=True)
    with zipfile.ZipFile(CORPUS / f"{target}.zip", "w", zipfile.ZIP_DEFLATED) as packed:
        for number, data in enumerate(inputs):
            packed.writestr(zipfile.ZipInfo(f"{number:04}", WHEN), data)
    return len(inputs)


def main(target: str, folders: Sequence[str]) -> int:
    with tempfile.TemporaryDirectory() as old, tempfile.TemporaryDirectory() as kept:
        if (CORPUS / f"{target}.zip").exists():
            unpack(target, Path(old))
        minimise(target, [Path(old), *map(Path, folders)], Path(kept))
        print(f"{target}: {pack(target, Path(kept))} inputs")
    return 0


if __name__ == "__main__":
    if len(sys.argv) < 2 or sys.argv[1] not in TARGETS:
        sys.exit(__doc__)
    sys.exit(main(sys.argv[1], sys.argv[2:]))
