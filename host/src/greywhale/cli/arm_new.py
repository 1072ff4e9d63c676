"""`greywhale arm new`: an arm.toml from a ruler, a scale and data sheets."""

from __future__ import annotations

import contextlib
import itertools
import sys
from collections.abc import Iterator
from pathlib import Path
from typing import Annotated, TypedDict

import click
import numpy as np

from greywhale.arm.make import Summary, assemble, summarise
from greywhale.arm.make.answers import Answer, answers_toml, read_answers
from greywhale.arm.make.explain import explain
from greywhale.arm.make.questions import Answers, Question, collect
from greywhale.arm.parameters import JOINT_NAMES, ArmParameters
from greywhale.base.errors import UserError, counted
from greywhale.base.formats.whole import refuse_inputs, write_text
from greywhale.cli.output import FILE, json_option, option, overwrite_option, show, tell
from greywhale.files.model import arm_toml
from greywhale.files.outputs import require_new
from greywhale.protocol.table import ParameterTable

MUCH_TO_HOLD = 0.6  # of stall_volts: the rest is for starting


class JointFacts(TypedDict):
    joint: int
    gravity_nm: float  # the largest torque of gravity
    stall_nm: float  # the motor's torque at standstill
    no_load_speed_rad_s: float
    hold_v: float  # holds the worst pose
    holds_without_power: bool


class NewAnswer(TypedDict):
    written: str  # the file
    mass_kg: float
    joints: Annotated[list[JointFacts], ("minItems", 1), ("maxItems", 4)]  # in use
    warnings: list[str]
    before_it_moves: str  # what to do; empty where nothing
    left_out: list[str]  # answers that were taken as usual


@click.command("new")
@option("--answers", type=FILE, metavar="FILE", help="TOML with the answers, for scripts.")
@option("--out", "-o", type=FILE, default="arm.toml")
@overwrite_option
@json_option(NewAnswer)
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
    text = [*_table(arm, found), *_notes(found, left_out), ""] if answers is not None else []
    show(as_json, _facts(out, found, left_out), "\n".join([*text, f"{out} is written."]))


def _agreed(person: Person, out: Path) -> ArmParameters:
    """The arm that somebody describes, and wants after a look at what it can lift."""
    while True:
        arm = assemble(person.answers())
        found = summarise(arm)
        tell("\n".join(["", *_table(arm, found), *_notes(found, ()), ""]))
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
        self._given: list[Answer] = []
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
                path = _free_name(self._out)
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
            self._given.append(Answer(question, self._live(question)))
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


def _free_name(out: Path) -> Path:
    """arm.answers.toml beside arm.toml, or the next name that is free."""
    ends = itertools.chain([""], (f"-{number}" for number in itertools.count(2)))
    names = (out.with_name(f"{out.stem}.answers{end}.toml") for end in ends)
    return next(path for path in names if not path.exists())


def _asked(question: Question) -> str:
    usual = question.usual if isinstance(question.usual, str) else f"{question.usual:.6g}"
    return f"{question.text}{', ' if question.unit.name else ''}{question.unit.name} [{usual}]"


def _table(arm: ArmParameters, found: Summary) -> list[str]:
    lines = [f"{arm.name}: {found.mass:.3g} kg, motors at {arm.drive.supply:g} V.", ""]
    lines.append(f"{'':16}{'gravity, at most':>18}{'motor at standstill':>21}{'share':>8}{'fastest':>14}")
    for one in found.joints:
        lines.append(
            f"{JOINT_NAMES[one.joint]:16}{one.gravity:>14.3g} N m{one.stall:>17.3g} N m{100 * one.share:>6.0f} %"
            f"{np.degrees(one.no_load_speed):>8.0f} deg/s"
        )
    return lines


def _notes(found: Summary, left_out: tuple[str, ...]) -> list[str]:
    notes = [f"Warning: {warning}" for warning in found.warnings]
    if advice := _advice(found):
        notes.append(f"Before it moves: {advice}")
    if left_out:
        notes.append(f"Note: the file leaves out {len(left_out)} answers, taken as usual: {', '.join(left_out)}.")
    return ["", *notes] if notes else []


def _advice(found: Summary) -> str:
    """What a board as shipped needs for an arm whose motors have much to hold; "" where it needs nothing."""
    hold = max(one.hold_v for one in found.joints)
    shipped = ParameterTable.defaults().physical("stall_volts")
    if hold <= MUCH_TO_HOLD * shipped or any(one.share >= 1.0 for one in found.joints):
        return ""
    return (
        f"a joint needs {hold:.1f} V to hold still, and the board holds a joint back that has more than stall_volts "
        f"({shipped:g} V) without motion: run `greywhale params set stall_volts={np.ceil(1.5 * hold):.0f}`."
    )


def _facts(out: Path, found: Summary, left_out: tuple[str, ...]) -> NewAnswer:
    joints: list[JointFacts] = [
        {
            "joint": one.joint,
            "gravity_nm": round(one.gravity, 6),
            "stall_nm": round(one.stall, 6),
            "no_load_speed_rad_s": round(one.no_load_speed, 6),
            "hold_v": round(one.hold_v, 4),
            "holds_without_power": one.holds,
        }
        for one in found.joints
    ]
    return {
        "written": str(out),
        "mass_kg": round(found.mass, 6),
        "joints": joints,
        "warnings": list(found.warnings),
        "before_it_moves": _advice(found),
        "left_out": list(left_out),
    }
