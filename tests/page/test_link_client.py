"""The page's link client, in Node: the golden vectors of shared/link, damaged bytes, requests and their replies."""

from __future__ import annotations

import json
import os
import subprocess
import tomllib
from pathlib import Path

from tools import ROOT

PAGE = ROOT / "host" / "web"


def test_the_link_client_keeps_the_golden_vectors_and_survives_damage(tmp_path: Path) -> None:
    golden = tmp_path / "golden.json"
    golden.write_text(json.dumps(tomllib.loads((ROOT / "shared/link/golden.toml").read_text("utf-8"))))
    command = ["node", "build.mjs", "test"]
    done = subprocess.run(
        command, cwd=PAGE, env={**os.environ, "GOLDEN": str(golden)}, capture_output=True, text=True, check=False
    )
    assert done.returncode == 0, done.stdout + done.stderr
