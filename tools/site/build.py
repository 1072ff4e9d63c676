"""Puts the page with a bench inside into one folder of files that any web server can hand out, and into one file."""

from __future__ import annotations

import hashlib
import json
import re
import shutil
from pathlib import Path

from greywhale.board.flash import BOARDS
from greywhale.board.flash.readback import shipped_image
from greywhale.files.arm import default_arm
from tools.setup import page, page_modules
from tools.site.bench_data import bench_data
from tools.site.tuner_data import tuner_data

AT_THE_TOP = ("index.html", "offline.js", "greywhale.html")


def build(folder: Path) -> None:
    """Write index.html with its parts, and all of it as greywhale.html; nothing else stays."""
    shutil.rmtree(folder, ignore_errors=True)
    parts = folder / "parts"
    page.npm("run", "site", str(parts), what="Building the page with a bench inside")
    write_bench(parts)
    for board in BOARDS:
        shutil.copyfile(shipped_image(board).path, parts / f"{board}.hex")
    page.npm("run", "single", str(parts), what="Building the page as one file")
    arrange(folder, parts)


def arrange(folder: Path, parts: Path) -> None:
    """Name the folder of the parts by their digest, so that no browser takes one for another build's."""
    for name in AT_THE_TOP:
        (parts / name).rename(folder / name)
    files = sorted(path for path in parts.iterdir())
    digest = hashlib.sha256(b"".join(path.name.encode() + path.read_bytes() for path in files)).hexdigest()[:16]
    index, offline = folder / "index.html", folder / "offline.js"
    text = index.read_text(encoding="utf-8")
    index.write_text(re.sub(r'(href|src)="(page\.\w+)"', rf'\1="{digest}/\2"', text), encoding="utf-8")
    known = f"const BUILD = {json.dumps(digest)}, PARTS = {json.dumps([f'{digest}/{path.name}' for path in files])};\n"
    offline.write_text(known + offline.read_text(encoding="utf-8"), encoding="utf-8")
    parts.rename(folder / digest)


def write_bench(folder: Path) -> None:
    """Write the modules and their data."""
    for module in page_modules.MODULES:
        shutil.copyfile(module.path, folder / module.path.name)
    for name, data in (("bench", bench_data(default_arm())), ("tuner", tuner_data())):
        (folder / f"{name}.json").write_text(json.dumps(data, separators=(",", ":")), encoding="utf-8")
