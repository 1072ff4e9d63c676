"""Every file has a licence, the GPL stays in simulated board and bench, the texts are where people look for them."""

from __future__ import annotations

import json
import subprocess
import sys

import pytest

from tools import ROOT


@pytest.mark.slow
def test_no_file_is_without_a_licence_and_the_gpl_covers_simulated_board_and_bench_and_nothing_else() -> None:
    command = [sys.executable, "-m", "reuse", "--root", str(ROOT), "lint", "--json"]
    answer = json.loads(subprocess.run(command, stdout=subprocess.PIPE, text=True, check=False).stdout)
    assert answer["summary"]["compliant"], answer["non_compliant"]
    files = {one["path"]: {found["value"] for found in one["spdx_expressions"]} for one in answer["files"]}
    under_gpl = {name for name, licences in files.items() if licences == {"GPL-3.0-or-later"}}
    by_others = {name for name, licences in files.items() if licences == {"GPL-2.0-or-later"}}
    apart = ("sim/arm/", "sim/web/")
    bench = {name for name in files if name.startswith("sim/") and not name.startswith(apart)} - by_others
    assert under_gpl == bench
    assert "sim/board/board.cpp" in bench
    assert {name for name in by_others if "/bootloaders/" not in name} == set()
    assert all(files[name] == {"Apache-2.0"} for name in files.keys() - under_gpl - by_others)


def test_the_texts_are_the_same_where_pip_and_where_reuse_look() -> None:
    assert (ROOT / "LICENSE").read_bytes() == (ROOT / "LICENSES" / "Apache-2.0.txt").read_bytes()
    assert (ROOT / "sim" / "LICENSE").read_bytes() == (ROOT / "LICENSES" / "GPL-3.0-or-later.txt").read_bytes()
