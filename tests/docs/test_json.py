"""What every verb really prints with --json is what its schema in docs/schemas says."""

from __future__ import annotations

import json
from dataclasses import replace
from pathlib import Path
from typing import Any

import click
import pytest
from jsonschema import Draft202012Validator, ValidationError

from greywhale.cli.story.learn import Learnt
from greywhale.cli.verbs import VERBS, greywhale
from tests.docs.running import Once, run, writes_over
from tools import ROOT
from tools.docs.schemas import SCHEMAS, read_answer, schema_name, validate
from tools.support.hands import SECOND_DEG, Hands, bench_of, mounted_anyhow, run_calibrate

# Verb -> ways to call it that print different keys.
CALLS = {
    "ports": [""],
    "udev": [""],
    "info": [""],
    "doctor": ["--seconds 0.5"],
    "flash": ["--hex firmware.hex"],
    "upload": ["controller.toml"],
    "params get": ["", "joint0.kp"],
    "params set": ["joint0.kp=0.8 supply_mv=14000"],
    "params backup": ["new.toml"],
    "params diff": ["board.toml"],
    "params restore": ["board.toml"],
    "record": ["--seconds 0.5", "--excite --seconds 4 --budget 2 --save-motion new.csv"],
    "replay": ["motion.csv --out replayed.csv"],
    "stop": ["", "--clear-fault"],
    "evaluate": ["log.csv", "log.csv before.csv --picture both.svg"],
    "identify": ["fit.csv --validate second.csv"],
    "tune": ["model.toml", "model.toml --tables"],
    "commission": ["--model model.toml"],
    "demo": ["--controller controller.toml"],
    "sim": ["--speed max"],
    "export": ["--fis controller.toml --out c.fis", "--urdf arm.toml --out a.urdf"],
    "arm new": ["--answers answers.toml --out new.toml"],
    "arm match": ["arm.toml --out matched.toml"],
    "arm import": ["arm.urdf --out imported.toml"],
    "reproduce": ["--quick --out report"],
    "compare": ["--functions sphere --methods gwo-woa,de --budget 60 --seeds 2 --jobs 1"],
}
# A verb with a test of its own.
BELOW = ("calibrate",)


def leaves(group: click.Group, above: str = "") -> set[str]:
    """The commands that run something, by their words."""
    context = click.Context(group)
    found: set[str] = set()
    for name in group.list_commands(context):
        command = group.get_command(context, name)
        found |= leaves(command, f"{above}{name} ") if isinstance(command, click.Group) else {f"{above}{name}"}
    return found


def test_every_verb_is_called_and_has_a_schema() -> None:
    assert {name.split()[0] for name in leaves(greywhale)} == set(VERBS)
    assert leaves(greywhale) == {*CALLS, *BELOW}
    wanted = {schema_name(verb) for verb in (*CALLS, *BELOW, "error")}
    assert {path.name for path in SCHEMAS.glob("*.json")} == wanted
    page = (ROOT / "docs" / "json.md").read_text(encoding="utf-8")
    assert [name for name in sorted(wanted) if f"docs/schemas/{name}" not in page] == []


@pytest.mark.parametrize("path", sorted(SCHEMAS.glob("*.json")), ids=lambda path: path.stem)
def test_a_schema_is_one_and_leaves_no_key_open(path: Path) -> None:
    schema = json.loads(path.read_text(encoding="utf-8"))
    Draft202012Validator.check_schema(schema)
    assert schema["additionalProperties"] is False
    with pytest.raises(ValidationError):
        Draft202012Validator(schema).validate({"unheard_of": 1})


def undescribed(schema: Any, where: str = "") -> list[str]:
    """Keys, at any depth, of which the schema does not say what they are."""
    found: list[str] = []
    for kind in ("properties", "patternProperties"):
        for key, value in schema.get(kind, {}).items():
            found += [f"{where}.{key}"] if "description" not in value else []
            found += undescribed(value, f"{where}.{key}")
    below = [schema[kind] for kind in ("items", "additionalProperties") if isinstance(schema.get(kind), dict)]
    return found + [key for one in below for key in undescribed(one, f"{where}[]")]


@pytest.mark.parametrize("name", ["commission", "demo", "evaluate", "identify", "tune"])
def test_every_key_is_described(name: str) -> None:
    assert undescribed(json.loads((SCHEMAS / f"{name}.json").read_text(encoding="utf-8"))) == []


@pytest.mark.parametrize("text", ['{"a": NaN}\n', '{"a": 1}\n{}\n', '{"a": 1}'])
def test_what_is_no_line_of_json_is_found(text: str) -> None:
    with pytest.raises(ValueError, match="NaN is no JSON|where there must be one"):
        read_answer(text)


@pytest.mark.slow
@pytest.mark.parametrize("verb", CALLS)
def test_what_a_verb_prints_is_what_its_schema_says(verb: str, scratch: Path, fresh_board: None, once: None) -> None:
    for call in CALLS[verb]:
        force = ["--force"] if verb == "tune" else []
        words = [*verb.split(), *call.split()]
        done = run([*words, *force, *writes_over(words), "--json"])
        assert done.code == 0, done.err
        validate(verb, read_answer(done.out))


@pytest.mark.slow
def test_calibrate(tmp_path: Path) -> None:
    with bench_of(mounted_anyhow(1), tmp_path) as bench:
        second = ",".join(f"{angle:g}" for angle in SECOND_DEG)
        done = run_calibrate(Hands(bench), tmp_path, "--joints", "1", "--second", second)
    assert done.code == 0, done.said
    validate("calibrate", read_answer(done.printed))


@pytest.mark.slow
def test_a_demo_that_learns(demonstrated: Once, identified: Once, tuned: Once) -> None:
    learnt = Learnt(Path("model.toml"), Path("controller.toml"), identified(), tuned(), 1.0, 2.0)
    facts = replace(demonstrated(), learnt=learnt).as_dict()
    validate("demo", read_answer(json.dumps(facts) + "\n"))


@pytest.mark.parametrize("arguments", ["evaluate none.csv", "record --budget 3", "dance"])
def test_a_failure(arguments: str, scratch: Path) -> None:
    done = run([*arguments.split(), "--json"])
    answer = read_answer(done.out)
    validate("error", answer)
    assert answer["exit_code"] == done.code
