"""Every verb really prints with --json what its schema says, which is made from the type of its answer."""

from __future__ import annotations

import functools
import json
from collections.abc import Iterator
from dataclasses import replace
from pathlib import Path
from typing import Any

import pytest
from jsonschema import Draft202012Validator, ValidationError

from greywhale.cli.story.learn import Learnt
from greywhale.cli.verbs import all_verbs
from tests.docs.running import Once, run, writes_over
from tools.docs.schemas import answers, schema_of, schemas

# Verb -> ways to call it that print different keys.
CALLS = {
    "ports": [""],
    "calibrations": ["", "--back 1"],
    "udev": [""],
    "info": [""],
    "dashboard": ["--no-browser"],
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
    "clutch": ["disengage", "engage"],
    "evaluate": [
        "log.csv",
        "log.csv before.csv --picture both.svg",
        "--repeatability plain.csv loaded.csv --arm arm.toml",
        "log.csv --model model.toml",
    ],
    "identify": ["fit.csv --validate second.csv"],
    "tune": ["model.toml", "model.toml --tables"],
    "commission": ["--model model.toml"],
    "adapt": ["model.toml --seconds 1 --out new.toml"],
    "demo": ["--controller controller.toml"],
    "sim": ["--speed max", "--mistake list"],
    "export": [
        "log.csv --to npz --out log.npz",
        "--fis controller.toml --out c.fis",
        "--urdf arm.toml --out a.urdf",
        "--header controller.toml --out law.h",
    ],
    "import": ["log.npz --from npz --out new.csv"],
    "fis": ["sets.fis", "sets.fis --controller controller.toml --joint 0 --out edited.toml"],
    "arm new": ["--answers answers.toml --out new.toml"],
    "arm match": ["arm.toml --out matched.toml"],
    "arm import": ["arm.urdf --out imported.toml"],
    "reproduce": ["--quick --out report"],
    "compare": ["--functions sphere --methods gwo-woa,de --budget 60 --seeds 2 --jobs 1"],
}
# tests/board/calibrate looks at what a whole calibration prints.
ELSEWHERE = ("calibrate",)


known = functools.cache(schemas)


def read_answer(text: str) -> Any:
    """The JSON that a verb printed: one line that holds one object, without the NaN that Python would let pass."""
    if text.count("\n") != 1:
        raise ValueError(f"{text.count(chr(10))} lines, where there must be one")
    return json.loads(text, parse_constant=_refuse)


def _refuse(name: str) -> Any:
    raise ValueError(f"{name} is no JSON")


def validate(verb: str, answer: Any) -> None:
    Draft202012Validator(known()[verb]).validate(answer)


def test_every_verb_is_called() -> None:
    assert {name.split()[0] for name in answers()} == {*all_verbs(), "error"}
    assert set(answers()) == {*CALLS, *ELSEWHERE, "error"}


@pytest.mark.parametrize("verb", [*CALLS, *ELSEWHERE, "error"])
def test_a_schema_is_one_and_asks_for_keys(verb: str) -> None:
    Draft202012Validator.check_schema(known()[verb])
    with pytest.raises(ValidationError):
        validate(verb, {})


def test_a_schema_describes_its_keys_and_knows_no_other_types() -> None:
    assert known()["error"]["properties"]["error"]["description"]
    with pytest.raises(TypeError, match="is no type of an answer"):
        schema_of(set[int])


def spoilt(answer: Any) -> Iterator[Any]:
    """Copies with something else in the place of one part, wherever that stands, or with a key too many."""
    odd: list[Any] = [[[[]]]]
    yield odd
    if isinstance(answer, dict):
        yield answer | {"unheard_of": odd}
        yield from (answer | {key: other} for key, part in answer.items() for other in spoilt(part))
    elif isinstance(answer, list) and answer:
        yield from ([other, *answer[1:]] for other in spoilt(answer[0]))


@pytest.mark.slow
@pytest.mark.parametrize("verb", CALLS)
def test_what_a_verb_prints_is_what_its_schema_says(verb: str, scratch: Path, fresh_board: None, once: None) -> None:
    for call in CALLS[verb]:
        force = ["--force"] if verb == "tune" else []
        words = [*verb.split(), *call.split()]
        done = run([*words, *force, *writes_over(words), "--json"])
        assert done.code == 0, done.err
        answer = read_answer(done.out)
        validate(verb, answer)
        check = Draft202012Validator(known()[verb])
        assert [other for other in spoilt(answer) if check.is_valid(other)] == []


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
