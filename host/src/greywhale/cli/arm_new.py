"""`greywhale arm new`: an arm.toml from a ruler, a scale and data sheets."""

from __future__ import annotations

import contextlib
import sys
from collections.abc import Iterator
from pathlib import Path

import click

from greywhale.arm.make import Summary, assemble, summarise
from greywhale.arm.make.answers import GivenAnswer, answers_toml, read_answers
from greywhale.arm.make.explain import explain
from greywhale.arm.make.questions import Answers, Question, collect
from greywhale.arm.parameters import ArmParameters
from greywhale.base.errors import UserError, counted
from greywhale.base.formats.whole import free_name, refuse_inputs, write_text
from greywhale.base.telling import Sentences, Step, Telling
from greywhale.cli.arm_table import Lifting, lifting, notes, table
from greywhale.cli.output import FILE, json_option, option, overwrite_option, show, tell
from greywhale.files.model import arm_toml
from greywhale.files.outputs import require_new


class ArmNewAnswer(Lifting):
    written: str  # the file
    left_out: list[str]  # answers that were taken as usual


@click.command("new")
@option("--answers", type=FILE, metavar="FILE", help="TOML with the answers, for scripts.")
@option("--out", "-o", type=FILE, default="arm.toml")
@overwrite_option
@json_option(ArmNewAnswer)
def new(answers: Path | None, out: Path, overwrite: bool, as_json: bool) -> None:
    """Ask for lengths, masses or materials, motors' data sheets and ranges; write an arm.toml.

    Enter takes what stands in brackets, ? explains the question, back asks the one before again. A number may have
    another unit: 14 cm, 5 kg cm. Before it writes, it shows what the arm can lift and how fast it is. Ctrl-C leaves the
    answers so far in a file for --answers.
    """
    refuse_inputs(out, answers)
    require_new(overwrite, out)
    if answers is None:
        person = Person(out)
        with person.kept():
            arm = _agreed(person, out)
        left_out: tuple[str, ...] = ()
    else:
        given, left_out = read_answers(answers)
        arm = assemble(given)
    found = summarise(arm)
    write_text(out, arm_toml(arm, "Made by greywhale arm new."))
    parts = [*table(arm, found), *notes(found, left_out)] if answers is not None else []
    steps = (Step("arm match", "Take the potentiometers as they are calibrated", {"arm": str(out)}),)
    show(as_json, _facts(out, found, left_out), Telling((*parts, Sentences((f"{out} is written.",))), steps))


def _agreed(person: Person, out: Path) -> ArmParameters:
    """The arm that somebody describes, and wants after a look at what it can lift."""
    while True:
        arm = assemble(person.answers())
        found = summarise(arm)
        tell(f"\n{Telling((*table(arm, found), *notes(found))).text()}\n")
        try:
            person.confirm(f"Write {out}?", f"{out} was not written.")
        except Back:
            person.go_back()
        else:
            return arm


class Back(Exception):
    """Somebody wants the question before again."""


class Person:
    """Somebody at this terminal, or a script that writes a line for each question."""

    def __init__(self, out: Path) -> None:
        self._out = out
        self._given: list[GivenAnswer] = []
        self._place = 0  # of the next question among them
        self._heading = self._shown = ""

    def answers(self) -> Answers:
        """Ask from the first question that has no answer yet; `back` takes the last answer away."""
        while True:
            self._place = 0
            try:
                return collect(self)
            except Back:
                self.go_back()

    def go_back(self) -> None:
        del self._given[-1:]
        self._shown = ""

    @contextlib.contextmanager
    def kept(self) -> Iterator[None]:
        """Whatever ends the questions, their answers so far are not lost."""
        try:
            yield
        except (UserError, KeyboardInterrupt) as error:
            if self._given:
                path = free_name(self._out.with_name(f"{self._out.stem}.answers.toml"))
                write_text(path, answers_toml(self._given))
                error.add_note(
                    f"Your {counted(len(self._given), 'answer')} are in {path}: `greywhale arm new --answers {path}` "
                    "takes them, and what is usual for the rest."
                )
            raise

    def heading(self, text: str) -> None:
        self._heading = text

    def ask(self, question: Question) -> float | str:
        if self._place == len(self._given):
            self._given.append(GivenAnswer(question, self._live(question)))
        self._place += 1
        return self._given[self._place - 1].value

    def confirm(self, what: str, otherwise: str) -> None:
        """Until Enter; anything else leaves everything as it is."""
        if self._line(f"{what} [Enter; no; back]: ").lower() not in ("", "y", "yes"):
            raise UserError(otherwise)

    def _live(self, question: Question) -> float | str:
        if self._heading != self._shown:
            click.echo(f"\n{click.wrap_text(self._heading)}", err=True)
            self._shown = self._heading
        while True:
            answer = self._line(f"  {_asked(question)}: ")
            if answer == "?":
                click.echo(click.wrap_text(explain(question), 76, "    ", "    "), err=True)
                continue
            try:
                return question.read(answer) if answer else question.usual
            except ValueError as error:
                tell(f"    Not {answer[:40]!r}: {error}.")

    def _line(self, prompt: str) -> str:
        click.echo(prompt, nl=False, err=True)
        line = sys.stdin.readline()
        if not line:
            raise UserError(f"the input ended in the middle of the questions; {self._out} was not written.")
        if line.strip().lower() == "back":
            raise Back
        return line.strip()


def _asked(question: Question) -> str:
    usual = question.usual if isinstance(question.usual, str) else f"{question.usual:.6g}"
    return f"{question.text}{', ' if question.unit.name else ''}{question.unit.name} [{usual}]"


def _facts(out: Path, found: Summary, left_out: tuple[str, ...]) -> ArmNewAnswer:
    return {"written": str(out), **lifting(found), "left_out": list(left_out)}
