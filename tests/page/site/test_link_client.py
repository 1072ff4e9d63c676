"""The page's parts in Node: link client, samples, law, files, against what Python makes of the same; its own bench."""

from __future__ import annotations

import json
import os
import subprocess
import tomllib
from collections.abc import Callable, Iterable
from dataclasses import asdict, fields
from fractions import Fraction
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from greywhale.base.errors import UserError
from greywhale.files import controller, parameter_file
from greywhale.files.paper_tables import paper_table
from greywhale.fuzzy.exact import Law
from greywhale.fuzzy.settings import ANGLE_UNIT, SET_UNIT, JointSettings
from greywhale.protocol.joints import ALL
from greywhale.protocol.schema import LAYOUT, PARAMETER_BY_NAME, PARAMETERS, Refusal
from greywhale.protocol.table import ParameterTable
from tests.page.site.calibrations import calibrations
from tests.page.site.predictions import predictions, spoilt_arms
from tests.page.site.tuning import tuning
from tools import ROOT
from tools.setup.page import node

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
            raw[name] = int(chance.choice([side * abs(raw[name]), side * 100, -side * 900, 2 * SET_UNIT - 1], p=ODDS))
    return JointSettings(**raw)


def numbers_of_the_law() -> dict[str, list[dict[str, Any]]]:
    """Inputs and outputs of the exact law, and why settings are refused."""
    chance = np.random.default_rng(1)
    cases: list[dict[str, Any]] = []
    refused: list[dict[str, Any]] = []
    while len(cases) < 200 or len(refused) < 800:
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


# What a person may get wrong in a controller.toml: a text and what stands in its place, once.
SLIPS = (
    *[
        ("kp = ", one)
        for one in ("kq = ", "kp = 1", "kp = -", "kp = true #", 'kp = "x" #', "kp = [1] #", "#", "kp = nan #")
    ],
    *[("kd = ", one) for one in ("kd = 0.000001 #", "kd = 1e-30 #", "kd = 65 #", "kd = 1e300 #", "kd = -0.5 #")],
    *[("ku = ", one) for one in ("ku = 30.5 #", "ku = 0.0001 #", "ku = 2023-01-01 #")],
    *[("Ne_c = ", one) for one in ("Ne_d = ", "Ne_c = 0.5 #", "Ne_c = -0.001 #", "Ne_c = -2 #", "Ne_c = -1e6 #", "#")],
    ("[joint.sets]", "ce_ticks = 2\n[joint.sets]"),
    ("[joint.sets]", "ce_ticks = 1.5\n[joint.sets]"),
    ("[joint.sets]", "ce_ticks = 21\n[joint.sets]"),
    ("[joint.sets]", "[joint.set]"),
    ("[joint.sets]", "sets = 3\n[joint.other]"),
    *[("[[joint]]", one) for one in ("[[join]]", "[[joint]]\n[[joint]]", "[joint]", "stall_volts = 3.2\n[[joint]]")],
    *[("[[joint]]", f"stall_volts = {one}\n[[joint]]") for one in ("30", '"3"', "inf", "0")],
    ("[[joint]]", "source = 5\n[[joint]]"),
    ("[[joint]]", "tuning = 5\n[[joint]]"),
    ("[[joint]]", "[travel]\nspeed_per_volt = [1, 2, 3]\ngravity_1 = 0.5\n[[joint]]"),
)
PARAMETER_SLIPS = (
    *[
        ("period_ms = 1 ", one)
        for one in ("period_ms = 51 ", "period_ms = 1.5 ", "", "period = 2 ", "period_ms = true ", "period_ms = inf ")
    ],
    *[
        ("period_ms = 1 ", f"period_ms = {one} ")
        for one in ('"x"', "[1, 2.5, {a = 1}]", "{a = [true]}", "2023-01-01", "=")
    ],
    *[("kp = 0.513", f"kp = {one}") for one in ("1e-9", "65", "-0.1", "1e300")],
    ("unrest_rate = 6", ""),
    ("motor_sign = 1", "motor_sign = 0"),
    ("limit_min = -2.5", "limit_min = 2.6"),
    ("[leader1]", "[leader4]"),
    ("[leader1]", "[leader0.inside]"),
)
OTHERS = ("", "# nothing", "a = 1", "time_s,leader_0\n0,1", "[[joint]]\nmotor = 1", "supply_v = 3", "x = [")
TRAVEL = """
[travel]
speed_per_volt = [0.75, 1, 1.5, {speed}]
time_constant = [400, 100, 80, 50.5]
breakaway_volts = [0, 1, 2, 3]
gravity_1 = 1.5
gravity_12 = -0.5
gravity_2 = 0
"""


def answers_to_controllers() -> list[dict[str, Any]]:
    """Controller files and others, each with its raw values or with the sentence that refuses it."""
    sound = "\n".join(
        line for line in paper_table("before_tuning").read_text("utf-8").splitlines() if not line.startswith("source")
    )
    texts = [sound, *(sound.replace(slip, made, 1) for slip, made in SLIPS)]
    texts += [
        sound.replace("kp = ", "kq = "),
        sound.replace("[[joint]]", "[[joint]]\nmotor = 1"),
    ]
    texts += [sound[: sound.rindex("[[joint]]")], sound + TRAVEL.format(speed=2), sound + TRAVEL.format(speed=9)]
    return answers([*texts, *OTHERS, "[joint0]\nkp = 1"], lambda path: controller.load(path).raw_values())


def answers(texts: Iterable[str], read: Callable[[Path], Any]) -> list[dict[str, Any]]:
    """Each text with what the host reads from a file of it, or with the sentence that refuses it."""
    cases = []
    for text in texts:
        told: dict[str, Any] = {"text": text, "raw": None, "error": ""}
        path = Path("c.toml")
        path.write_text(text, "utf-8")
        try:
            told["raw"] = read(path)
        except UserError as error:
            told["error"] = error.message
        cases.append(told)
    return cases


def answers_to_parameter_files() -> list[dict[str, Any]]:
    """Parameter files as the host writes them, of older layouts too, and others that a person has spoiled."""
    chance = np.random.default_rng(1)
    path = Path("p.toml")
    texts = []
    for _ in range(3):
        values = {one.name: int(chance.integers(one.minimum, one.maximum + 1)) or 1 for one in PARAMETERS}
        values |= {f"joint{joint}.limit_min": -25723 for joint in ALL}  # the least
        parameter_file.save(path, ParameterTable.defaults().with_raw(values))
        texts.append(path.read_text("utf-8"))
    parameter_file.save(path, ParameterTable.defaults())
    sound = path.read_text("utf-8")
    for layout in range(1, LAYOUT):
        newer = tuple(one.name.rpartition(".")[2] + " = " for one in PARAMETERS if one.since > layout)
        texts.append("".join(line for line in sound.splitlines(keepends=True) if not line.startswith(newer)))
    texts += [sound, *(sound.replace(slip, made, 1) for slip, made in PARAMETER_SLIPS), *OTHERS, "[[joint]]\nkp = 1"]
    assert len(set(texts)) == len(texts), "every slip is in the file"
    return answers(texts, stated_by_index)


def stated_by_index(path: Path) -> list[tuple[int, int]]:
    return [(PARAMETER_BY_NAME[name].index, raw) for name, raw in parameter_file.load_stated(path).items()]


def test_link_client_samples_law_files_bench_and_tuner_give_what_python_gives(
    folder: Path, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.chdir(tmp_path)
    golden, law, files = tmp_path / "golden.json", tmp_path / "law.json", tmp_path / "files.json"
    golden.write_text(json.dumps(tomllib.loads((ROOT / "shared/link/golden.toml").read_text("utf-8"))))
    law.write_text(json.dumps(numbers_of_the_law()))
    files.write_text(json.dumps(answers_to_controllers()))
    parameters = tmp_path / "parameters.json"
    parameters.write_text(json.dumps(answers_to_parameter_files()))
    calibrated = tmp_path / "calibrations.json"
    calibrated.write_text(json.dumps(calibrations()))
    tuned = tmp_path / "tuning.json"
    tuned.write_text(json.dumps(tuning()))
    predicted = tmp_path / "predictions.json"
    predicted.write_text(json.dumps({"cases": predictions(), "spoilt": spoilt_arms()}))
    given = {"CALIBRATIONS": calibrated, "GOLDEN": golden, "LAW": law, "CONTROLLER_FILES": files, "TUNING": tuned}
    given |= {
        "BOTH": ROOT / "tests/files/both",
        "PARAMETER_FILES": parameters,
        "PREDICTIONS": predicted,
        "SITE": next(path for path in folder.iterdir() if path.is_dir()),
    }
    environment = {**os.environ, **{name: str(path) for name, path in given.items()}}
    command = [str(node() / "bin/node"), "build.mjs", "test"]
    done = subprocess.run(command, cwd=PAGE, env=environment, capture_output=True, text=True, check=False)
    assert done.returncode == 0, done.stdout + done.stderr
