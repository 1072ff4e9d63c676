"""The questions about an arm as a form: all that follow from the answers so far, under their headings."""

from __future__ import annotations

from collections.abc import Mapping
from pathlib import Path
from typing import Any, TypedDict

from greywhale.arm.make.answers import TABLES, GivenAnswer
from greywhale.arm.make.explain import explain
from greywhale.arm.make.questions import Question, collect
from greywhale.base.errors import BadUsage, cut
from greywhale.base.formats import toml_file
from greywhale.base.formats.kinds import Kind, refuse_other_kind

LONGEST_ANSWER_LETTERS = 200  # so much of an answer is shown


class AskedQuestion(TypedDict):
    """One question; `where` is its name in the form's answers, such as link[1].length_mm."""

    where: str
    text: str
    unit: str
    choices: list[str]  # a number will do as well where it is `number`
    number: bool
    usual: str  # that holds where nothing is given
    given: str
    problem: str  # why what is given cannot be, "" if it can
    help: str


class Heading(TypedDict):
    heading: str
    questions: list[AskedQuestion]


class ArmForm:
    """A form with the answers that a person gave so far, by the questions' names; the usual ones hold for the rest."""

    def __init__(self, answers: Mapping[str, object]) -> None:
        self.headings: list[Heading] = []
        self.answers: list[GivenAnswer] = []
        self._given = answers
        collect(self)

    def heading(self, text: str) -> None:
        self.headings.append({"heading": text, "questions": []})

    def ask(self, question: Question) -> float | str:
        given = self._given.get(question.where)
        value, problem = question.usual, ""
        if given not in (None, ""):
            try:
                value = question.read(cut(given, LONGEST_ANSWER_LETTERS) if isinstance(given, str) else given)
            except ValueError as error:
                problem = f"{error}."
        self.answers.append(GivenAnswer(question, value))
        self.headings[-1]["questions"].append(
            {
                "where": question.where,
                "text": question.text,
                "unit": question.unit.name,
                "choices": list(question.choices),
                "number": question.high > question.low,
                "usual": _plain(question.usual),
                "given": "" if given is None else cut(_plain(given), LONGEST_ANSWER_LETTERS),
                "problem": problem,
                "help": explain(question),
            }
        )
        return value

    def require_sound(self) -> None:
        """BadUsage for the first answer that cannot be."""
        for heading in self.headings:
            for one in heading["questions"]:
                if one["problem"]:
                    raise BadUsage(f"{one['text']} ({one['where']}) is {cut(one['given'])!r}: {one['problem']}")


def answers_in(path: Path) -> dict[str, object]:
    """The answers in a file, by the questions' names."""
    read = toml_file.read(path)
    refuse_other_kind(read, str(path), Kind.ANSWERS)
    found: dict[str, object] = {}
    for name, value in read.items():
        tables: list[Any] = value if name in TABLES and isinstance(value, list) else []
        for number, table in enumerate(tables):
            if isinstance(table, dict):
                found |= {f"{name}[{number}].{key}": one for key, one in table.items()}
        if not tables:
            found[name] = value
    return found


def _plain(value: object) -> str:
    return f"{value:.6g}" if isinstance(value, float) else str(value)
