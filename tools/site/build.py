"""Puts the page with a bench inside into one folder of files that any web server can hand out, and into one file."""

from __future__ import annotations

import json
import shutil
from pathlib import Path

from greywhale.files.arm import default_arm
from tools.setup import bench_module, page
from tools.site.bench_data import bench_data


def build(folder: Path) -> None:
    """Write the page, its worker, the module and its data, and all of it as greywhale.html; nothing else stays."""
    page.npm("run", "site", str(folder), what="Building the page with a bench inside")
    write_bench(folder)
    page.npm("run", "single", str(folder), what="Building the page as one file")


def write_bench(folder: Path) -> None:
    """Write the module and its data."""
    shutil.copyfile(bench_module.MODULE, folder / bench_module.MODULE.name)
    data = json.dumps(bench_data(default_arm()), separators=(",", ":"))
    (folder / "bench.json").write_text(data, encoding="utf-8")
