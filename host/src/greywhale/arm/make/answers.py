"""Answers from a TOML file: what it leaves out is taken as usual and told; what nobody asks for is refused."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path
from typing import Any, NamedTuple

from greywhale.arm.make.questions import JOINTS_IN_USE, MOTOR_KEYS, SAME_MOTOR, Answers, Question, collect
from greywhale.arm.parameters import JOINT_NAMES
from greywhale.base.errors import BadUsage, cut
from greywhale.base.formats import toml_file, toml_text
from greywhale.base.formats.kinds import Kind, refuse_other_kind

TABLES = ("link", "joint")


class GivenAnswer(NamedTuple):
    """A question and what somebody answered."""

    question: Question
    value: float | str


def read_answers(path: Path) -> tuple[Answers, tuple[str, ...]]:
    """The answers, and the keys of those that the file leaves out. Raises UserError naming file, key and reason."""
    source = AnswersFile(path)
    answers = collect(source)
    source.refuse_rest()
    return answers, tuple(source.left_out)


def answers_toml(given: Sequence[GivenAnswer]) -> str:
    plain = [(one.question.key, one.value) for one in given if one.question.table is None]
    lines = [f"{key} = {toml_text.value(value)}" for key, value in plain]
    for name in TABLES:
        tables: dict[int, list[str]] = {}
        for question, value in given:
            if question.table is not None and question.table[0] == name:
                tables.setdefault(question.table[1], []).append(f"{question.key} = {toml_text.value(value)}")
        for number in range(max(tables, default=-1) + 1):
            lines += ["", f"[[{name}]]", *tables.get(number, [])]
    return "\n".join(lines) + "\n"


class AnswersFile:
    """Answers each question once from the file."""

    def __init__(self, path: Path) -> None:
        self.left_out: list[str] = []
        self._path = path
        self._rest = toml_file.read(path)
        refuse_other_kind(self._rest, str(path), Kind.ANSWERS)
        self._tables = {(name, number): one for name in TABLES for number, one in enumerate(self._take(name))}

    def heading(self, text: str) -> None:
        """A file needs none."""

    def ask(self, question: Question) -> float | str:
        table = self._rest if question.table is None else self._tables.get(question.table, {})
        if question.key not in table:
            if question.key == SAME_MOTOR:
                return "no" if any(key in table for key in MOTOR_KEYS) else "yes"
            if question.key != JOINTS_IN_USE:  # an arm has all four joints unless a file says otherwise
                self.left_out.append(question.where)
            return question.usual
        given = table.pop(question.key)
        try:
            return question.read(given)
        except ValueError as error:
            raise BadUsage(f"{self._path}: {question.where} is {cut(repr(given))}: {error}.") from None

    def refuse_rest(self) -> None:
        """Refuse what was not asked for."""
        rest = [
            *self._rest,
            *(f"{name}[{number}].{key}" for (name, number), one in self._tables.items() for key in one),
        ]
        if rest:
            raise BadUsage(
                f"{self._path}: {cut(rest[0])} answers no question that is asked here; remove it, or correct its name "
                "or place (docs/your-arm.md has an example)."
            )

    def _take(self, name: str) -> list[dict[str, Any]]:
        given = self._rest.pop(name, [])
        if (
            not isinstance(given, list)
            or not all(isinstance(one, dict) for one in given)
            or len(given) > len(JOINT_NAMES)
        ):
            raise BadUsage(
                f"{self._path}: {name} must be tables [[{name}]], one for each of the four {name}s from the base on."
            )
        return given
