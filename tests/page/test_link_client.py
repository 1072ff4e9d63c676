"""The page's parts in Node: link client, samples, law, against vectors and numbers that Python makes; its own bench."""

from __future__ import annotations

import json
import os
import subprocess
import tomllib
from dataclasses import asdict, fields
from fractions import Fraction
from pathlib import Path
from typing import Any

import numpy as np

from greywhale.fuzzy.exact import Law
from greywhale.fuzzy.settings import ANGLE_UNIT, SET_UNIT, JointSettings
from greywhale.protocol.schema import PARAMETER_BY_NAME, Refusal
from tests.page.tuning import tuning
from tools import ROOT
from tools.site.build import write_bench

PAGE = ROOT / "host" / "web"
NAMES = tuple(field.name for field in fields(JointSettings))
SETS, LEFT = NAMES[:8], ("ne_c", "ze_a", "nce_c", "zce_a")
ODDS = (0.94, 0.02, 0.02, 0.02)  # of a corner: as it should be, too narrow, on the wrong side, beyond the range


def any_settings(chance: np.random.Generator) -> JointSettings:
    """Settings of which about half are refused, for every reason."""
    raw: dict[str, int] = {}
    for name in NAMES:
        of = PARAMETER_BY_NAME[f"joint1.{name}"]
        raw[name] = int(chance.integers(of.minimum, of.maximum + 1))
        if name in SETS:
            side = -1 if name in LEFT else 1
            raw[name] = int(chance.choice([side * abs(raw[name]), side * 100, -side * 900, 2 * SET_UNIT], p=ODDS))
    return JointSettings(**raw)


def numbers_of_the_law() -> dict[str, list[dict[str, Any]]]:
    """Inputs and outputs of the exact law, and why settings are refused."""
    chance = np.random.default_rng(1)
    cases: list[dict[str, Any]] = []
    refused: list[dict[str, Any]] = []
    while len(cases) < 500 or len(refused) < 2000:
        settings = any_settings(chance)
        period_ms = int(chance.choice([1, 1, 1, 20, 50, 51]))
        told: dict[str, Any] = {"settings": asdict(settings), "period_ms": period_ms}
        reason = settings.refusal(period_ms)
        refused.append({**told, "refusal": int(reason)})
        if reason is Refusal.NONE:
            law = Law(settings, period_ms)
            # Gains are some 30: such errors reach the whole of -1..1 and beyond.
            error, change = (Fraction(int(size), ANGLE_UNIT) for size in chance.normal(0.0, (200, 40)))
            x, y = law.inputs(error, change)
            answer: dict[str, Any] = {"x": float(x), "y": float(y), "u": float(law.infer(error, change).u)}
            cases.append({**told, "error": float(error), "change": float(change), **answer})
    return {"cases": cases, "refused": refused}


def test_link_client_samples_law_bench_and_tuner_give_what_python_gives(tmp_path: Path) -> None:
    golden, law = tmp_path / "golden.json", tmp_path / "law.json"
    golden.write_text(json.dumps(tomllib.loads((ROOT / "shared/link/golden.toml").read_text("utf-8"))))
    law.write_text(json.dumps(numbers_of_the_law()))
    tuned = tmp_path / "tuning.json"
    tuned.write_text(json.dumps(tuning()))
    files = {"GOLDEN": golden, "LAW": law, "TUNING": tuned, "SITE": tmp_path}
    environment = {**os.environ, **{name: str(path) for name, path in files.items()}}
    write_bench(tmp_path)
    done = subprocess.run(
        ["node", "build.mjs", "test"], cwd=PAGE, env=environment, capture_output=True, text=True, check=False
    )
    assert done.returncode == 0, done.stdout + done.stderr
