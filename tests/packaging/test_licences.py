"""Every file has a licence: the Apache licence, but for the bootloaders. The texts are where people look for them."""

from __future__ import annotations

import json
import subprocess
import sys

import pytest

from tools import ROOT


@pytest.mark.slow
def test_no_file_is_without_a_licence_and_only_the_bootloaders_of_others_have_another() -> None:
    command = [sys.executable, "-m", "reuse", "--root", str(ROOT), "lint", "--json"]
    answer = json.loads(subprocess.run(command, stdout=subprocess.PIPE, text=True, check=False).stdout)
    assert answer["summary"]["compliant"], answer["non_compliant"]
    files = {one["path"]: {found["value"] for found in one["spdx_expressions"]} for one in answer["files"]}
    bootloaders = {name for name in files if "/bootloaders/" in name}
    assert "sim/bench/greywhale_sim/bootloaders/mega.hex" in bootloaders
    assert all(files[name] == {"GPL-2.0-or-later"} for name in bootloaders)
    assert all(files[name] == {"Apache-2.0"} for name in files.keys() - bootloaders)


@pytest.mark.parametrize(
    "place", ["LICENSES/Apache-2.0.txt", "studies/paper/LICENSE", "studies/lerobot_robot_greywhale/LICENSE"]
)
def test_the_text_is_the_same_where_pip_and_where_reuse_look(place: str) -> None:
    assert (ROOT / "LICENSE").read_bytes() == (ROOT / place).read_bytes()
