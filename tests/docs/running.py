"""Runs what the pages show: the verbs in this process, as the command line does, against the bench.

The rule, in order:

1. A command that needs hands or answers, `sudo`, a shell's start file, a real port or another machine is parsed, not
   run.
2. `make`, `pip` and `python -m` are looked at: the target, the package or the module must exist.
3. Every other verb is run as printed, with files of the scratch folder where a page speaks of yours. What would only
   take long is shortened by options behind the printed ones (SHORTER).
4. `identify`, `tune`, `commission`, `demo` and `reproduce` compute once for all pages (`Once`); reading, checking and
   writing is done for each. `sim` puts its bench and port together and ends, `dashboard` its server; `flash` greets a
   board that has the firmware.
"""

from __future__ import annotations

import contextlib
import importlib.util
import io
import re
from collections.abc import Callable
from dataclasses import dataclass
from typing import Any

import click

from greywhale.cli import entry
from greywhale.cli.verbs import all_verbs, greywhale
from tools import ROOT
from tools.docs.examples import Block, Command, split

SHORTER = {
    "record": "--seconds 0.5",
    "adapt": "--seconds 1",
    "record --excite": "--seconds 4 --budget 2",
    "info --watch": "--seconds 0.5",
    "dashboard": "--no-browser",
    "doctor": "--seconds 0.5",
    "compare": "--functions sphere --budget 60 --seeds 2 --jobs 1",
    "tune": "--force",  # the model is one of six seconds of log
}


@dataclass(frozen=True)
class Done:
    code: int
    out: str
    err: str


def run(arguments: list[str]) -> Done:
    """Run a verb as the command line does."""
    out, err = io.StringIO(), io.StringIO()
    with contextlib.redirect_stdout(out), contextlib.redirect_stderr(err):
        code = entry.run(arguments)
    return Done(code, out.getvalue(), err.getvalue())


def run_block(block: Block, names: dict[str, Any]) -> None:
    """Run a block of a page; `names` are those of the page's Python so far."""
    place = f"{block.page.relative_to(ROOT)}:{block.line}"
    if block.language == "python":
        code = compile("\n" * (block.line - 1) + block.text, str(block.page), "exec")
        with contextlib.redirect_stdout(io.StringIO()):
            exec(code, names)
        return
    for line in block.commands:
        said = run_line(line)
        assert said == "", f"{place}: {line}\n{said}"


def run_line(line: str) -> str:
    """Run or parse a line; what is wrong with it, "" for nothing."""
    command = split(line)
    words = command.words
    if words[:1] == ["eval"] and "_GREYWHALE_COMPLETE=" in line:
        return ""  # tests/cli tries completion
    if words[:1] == ["make"]:
        return _look_at_make(words[1:])
    if words[:2] == ["pip", "install"]:
        return "" if words[2:] == ["greywhale"] else "pip installs what is not ours"
    if words[:1] in (["git"], ["mkdir"]):
        return ""  # gets what others published
    if words == [".", ".venv/bin/activate"]:
        return ""  # changes a shell, and this is none
    if words[:2] == ["python", "-m"]:
        return "" if importlib.util.find_spec(words[2]) else f"there is no module {words[2]}"
    if words[:1] != ["greywhale"]:
        return "a test must learn what this is"
    if _is_parsed_only(command):
        return parse(words[1:])
    done = run([*words[1:], *_shorter(words[1:]), *writes_over(words[1:])])
    return "" if done.code == 0 else f"{done.code}: {done.err}"


def parse(arguments: list[str]) -> str:
    """Let the program's own parser look at a command without running it; what is wrong with it."""
    if not arguments:
        return ""  # the completion of a shell
    with contextlib.ExitStack() as stack:
        for command in (greywhale, *_commands(greywhale, arguments)):
            stack.callback(setattr, command, "callback", command.callback)
            command.callback = lambda **values: None
        try:
            greywhale.main(arguments, prog_name="greywhale", standalone_mode=False)
        except click.ClickException as error:
            return error.format_message()
    return ""


def _commands(group: click.Group, arguments: list[str]) -> list[click.Command]:
    """The commands that these arguments run, without the group's own."""
    context = click.Context(group)
    for place, word in enumerate(arguments):
        command = group.get_command(context, word)
        if command is not None:
            below = _commands(command, arguments[place + 1 :]) if isinstance(command, click.Group) else []
            return [command, *below]
    return []


def _is_parsed_only(command: Command) -> bool:
    everything = [*command.variables.values(), *command.words, *command.rest]
    needs_a_person = (
        command.words[1:2] == ["calibrate"]
        or "--episodes" in command.words
        or (command.words[1:3] == ["arm", "new"] and "--answers" not in command.words)
    )
    return (
        needs_a_person
        or "sudo" in everything
        or "--image" in everything
        or any(word.startswith(("/dev/tty", "~")) or "://" in word for word in everything)
    )


def writes_over(arguments: list[str]) -> list[str]:
    """--overwrite, where the verb has it: a page's reader does not have the files yet."""
    commands = _commands(greywhale, arguments)
    has = bool(commands) and any(one.name == "overwrite" for one in commands[-1].params)
    return ["--overwrite"] if has and "--overwrite" not in arguments else []


def _shorter(arguments: list[str]) -> list[str]:
    verb = next((word for word in arguments if word in all_verbs()), "")
    longer = {"record": "--excite", "info": "--watch"}.get(verb)
    key = f"{verb} {longer}" if longer in arguments else verb
    return [] if "--hex" in arguments else SHORTER.get(key, "").split()


def _look_at_make(words: list[str]) -> str:
    makefile = (ROOT / "Makefile").read_text(encoding="utf-8")
    for word in words:
        name, equals, value = word.partition("=")
        if equals and name != "ARGS":
            return f"make knows no {name}"
        if equals and words[0] == "demo":
            return parse(["demo", *value.split()])
        if not equals and not re.search(rf"^{re.escape(word)}:", makefile, re.MULTILINE):
            return f"there is no target {word}"
    return ""


class Once:
    """A computation that is done at its first call, and whose result all later calls get."""

    def __init__(self, compute: Callable[[], Any]) -> None:
        self._compute = compute
        self._results: list[Any] = []

    def __call__(self) -> Any:
        if not self._results:
            self._results.append(self._compute())
        return self._results[0]
