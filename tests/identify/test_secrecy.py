"""Identification sees logs and the user's files and nothing else: every file that it opens is watched."""

from __future__ import annotations

import json
import subprocess
import sys
from pathlib import Path

import pytest

from tools.support.recordings import TABLES, Recorded

WATCHED = """
import json, sys
opened = []
sys.addaudithook(lambda event, arguments: opened.append(str(arguments[0])) if event == "open" else None)
from greywhale.cli.entry import run
from greywhale.identify import bootstrap
bootstrap.LOGS = 0 # it takes long, and opens nothing
code = run(sys.argv[1:])
sys.stdout.flush()
bench = [name for name in sys.modules if name.split(".")[0] == "greywhale_sim"]
print(json.dumps({"code": code, "opened": opened, "bench": bench}))
"""
# Programs and their data are no knowledge about the arm.
PROGRAM = (".py", ".pyc", ".so", ".pyi", ".pth", ".json", ".dist-info")


@pytest.mark.slow
def test_only_the_logs_and_the_users_files_are_opened(shoulder: Recorded, log_folder: Path, tmp_path: Path) -> None:
    arm, controller = tmp_path / "arm.toml", tmp_path / "controller.toml"
    source = Path(__file__).parents[2] / "host" / "src" / "greywhale" / "arm" / "data" / "white_box.toml"
    arm.write_text(source.read_text(encoding="utf-8"), encoding="utf-8")
    controller.write_text((TABLES / "before_tuning.toml").read_text(encoding="utf-8"), encoding="utf-8")
    model = tmp_path / "model.toml"
    logs = [shoulder.fit.name, "--validate", shoulder.second.name]
    options = ["--arm", str(arm), "--controller", str(controller), "--out", str(model), "--json"]
    done = subprocess.run(
        [sys.executable, "-c", WATCHED, "identify", *logs, *options], capture_output=True, text=True, check=True
    )
    result, watched = (json.loads(line) for line in done.stdout.strip().splitlines())
    assert watched["code"] == 0
    assert watched["bench"] == []
    assert result["log"][1]["improvement"] > 0.97
    allowed = {shoulder.fit.name, shoulder.second.name, str(arm), str(controller)}
    read = {name for name in watched["opened"] if name.endswith((".toml", ".csv"))}
    assert read == allowed, "an arm or a log was read that the user did not name"
    here = str(tmp_path)
    others = [
        name
        for name in watched["opened"]
        if not name.endswith(PROGRAM) and name.startswith((here, str(log_folder))) and name not in allowed
    ]
    # The folder itself is opened to bring the model's name to the disk.
    assert all("model.toml" in name or name == here for name in others), others
