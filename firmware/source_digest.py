"""The digest of the firmware's sources, which every image carries: `python source_digest.py IMAGE.hex ...` checks it.

The build puts the digest into the image (image_record.py). Whoever packs an image checks that its digest is still that
of the sources beside it. Needs nothing but Python.
"""

from __future__ import annotations

import hashlib
import sys
from collections.abc import Iterator
from pathlib import Path

FIRMWARE = Path(__file__).resolve().parent
SOURCES = ("src", "lib", "platformio.ini", "image_record.py", "source_digest.py", "strict_warnings.py")
DIGITS = 16


def source_files(firmware: Path) -> Iterator[Path]:
    """Every file that an image is built from, in an order that depends on names only."""
    for name in SOURCES:
        place = firmware / name
        below = (path for path in place.rglob("*") if path.is_file() and "__pycache__" not in path.parts)
        yield from sorted(below) if place.is_dir() else [place]


def source_digest(firmware: Path) -> str:
    """Sixteen hexadecimal digits over names and contents; the place of the folder does not matter."""
    total = hashlib.sha256()
    for path in source_files(firmware):
        content = hashlib.sha256(path.read_bytes()).hexdigest()
        total.update(f"{path.relative_to(firmware).as_posix()} {content}\n".encode())
    return total.hexdigest()[:DIGITS]


def read_bytes(image: Path) -> bytes:
    """The bytes of an Intel HEX file in the order of its data records."""
    records = (bytes.fromhex(line[1:]) for line in image.read_text(encoding="ascii").split())
    return b"".join(record[4:-1] for record in records if record[3] == 0)


def main(images: list[str]) -> int:
    digest = source_digest(FIRMWARE)
    for name in images:
        image = Path(name)
        if not image.is_file():
            print(f"{image} is not built; run `make firmware`, or `pio run -d firmware`.", file=sys.stderr)
            return 1
        if digest.encode() not in read_bytes(image):
            print(
                f"{image} was built from other sources; run `make firmware`, or `pio run -d firmware`.", file=sys.stderr
            )
            return 1
    return 0


if __name__ == "__main__":
    sys.exit(main(sys.argv[1:]))
