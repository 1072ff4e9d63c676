"""What a user installs with pip is whole: built from the sdist alone, away from the checkout, it still runs."""

from __future__ import annotations

import os
import subprocess
import sys
from pathlib import Path

ROOT = Path(__file__).resolve().parents[2]
CHECK = """
import sys
# The checkout's editable install would win over PYTHONPATH.
sys.meta_path[:] = [finder for finder in sys.meta_path if not type(finder).__name__.startswith("ScikitBuild")]
from greywhale import _native, arm
from greywhale.config import controller
from greywhale.config.paper_tables import paper_table
import pathlib
for module in (_native, arm):
    assert pathlib.Path(module.__file__).is_relative_to(sys.argv[1]), module.__file__
assert paper_table("table_10").is_relative_to(sys.argv[1])
assert len(controller.load(paper_table("table_10")).joint) == 4
arm.Arm(arm.default_arm(), seed=0).step([0.0] * 4, 0.001)
"""


def test_sdist_builds_a_wheel_that_runs_without_the_checkout(tmp_path: Path) -> None:
    build = "import os, sys; from scikit_build_core.build import build_sdist; print(build_sdist(sys.argv[1]))"
    sdist = subprocess.run(
        [sys.executable, "-c", build, str(tmp_path)], cwd=ROOT, check=True, capture_output=True, text=True
    ).stdout.split()[-1]
    target = tmp_path / "site"
    pip = [sys.executable, "-m", "pip", "install", "--quiet", "--no-deps", "--no-build-isolation"]
    subprocess.run(
        [*pip, "-Cbuild-dir=" + str(tmp_path / "build"), "--target", str(target), str(tmp_path / sdist)], check=True
    )
    environment = {**os.environ, "PYTHONPATH": str(target)}
    subprocess.run([sys.executable, "-c", CHECK, str(target)], cwd=tmp_path, env=environment, check=True, timeout=60)
