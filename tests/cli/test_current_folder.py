"""The command in a folder full of a stranger's files: none of them is imported or obeyed, and the work is done."""

from __future__ import annotations

import json
import subprocess
import sys
from pathlib import Path

import matplotlib.image
import pytest

from tests.support.strangers import plant, ran

INSTALLED = [str(Path(sys.executable).with_name("greywhale"))]


COMPARE = "-q compare --functions sphere --methods cma-es --budget 20 --seeds 1 --workers 1 --out picture.png --json"


@pytest.mark.slow
def test_a_verb_that_draws_runs_nothing_of_the_current_folder(tmp_path: Path) -> None:
    """With CMA-ES, whose package imports Matplotlib too. The other verbs that draw do it the same way, which
    tests/test_structure.py watches; what a verb starts is tried in tests/base/test_processes.py.
    """
    plant(tmp_path)
    done = subprocess.run([*INSTALLED, *COMPARE.split()], cwd=tmp_path, capture_output=True, text=True, check=False)
    assert (done.returncode, done.stderr) == (0, "")
    json.loads(done.stdout)
    assert ran(tmp_path) == set()
    corner = matplotlib.image.imread(tmp_path / "picture.png")[0, 0]
    assert corner.tolist() == [1.0, 1.0, 1.0, 1.0], "the paper is white"
