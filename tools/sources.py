"""A digest of sources: what was measured of one state of the code is not taken for another's."""

from __future__ import annotations

import hashlib
from collections.abc import Iterable

from tools import ROOT


def digest_of(names: Iterable[str]) -> str:
    """Of all bytes in these files and folders of the repository; what is generated there apart."""
    digest = hashlib.sha256()
    for name in names:
        path = ROOT / name
        for file in sorted(path.rglob("*")) if path.is_dir() else [path]:
            if file.is_file() and "__pycache__" not in file.parts and ".pio" not in file.relative_to(ROOT).parts:
                digest.update(str(file.relative_to(ROOT)).encode() + b"\0" + file.read_bytes() + b"\0")
    return digest.hexdigest()[:16]
