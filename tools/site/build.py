"""Puts the page with a bench inside into one folder of files that any web server can hand out, and into one file."""

from __future__ import annotations

import json
import shutil
from pathlib import Path

from greywhale.files.arm import default_arm
from tools.setup import page, page_modules
from tools.site.bench_data import bench_data
from tools.site.tuner_data import tuner_data


def build(folder: Path) -> None:
    """Write the page, its workers, the modules and their data, and all of it as greywhale.html; nothing else stays."""
    page.npm("run", "site", str(folder), what="Building the page with a bench inside")
    write_bench(folder)
    page.npm("run", "single", str(folder), what="Building the page as one file")


def write_bench(folder: Path) -> None:
    """Write the modules and their data."""
    for module in page_modules.MODULES:
        shutil.copyfile(module.path, folder / module.path.name)
    for name, data in (("bench", bench_data(default_arm())), ("tuner", tuner_data())):
        (folder / f"{name}.json").write_text(json.dumps(data, separators=(",", ":")), encoding="utf-8")
