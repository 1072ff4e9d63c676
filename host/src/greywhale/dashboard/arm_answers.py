"""The form of `arm new`: a page gets the questions, and its answers become a file for --answers."""

from __future__ import annotations

from collections.abc import Mapping
from pathlib import PurePath
from typing import Any

from greywhale.arm.make.answers import answers_toml
from greywhale.arm.make.form import ArmForm, Heading, answers_in
from greywhale.base.errors import BadUsage
from greywhale.base.formats.whole import write_text
from greywhale.dashboard.folder import Folder
from greywhale.dashboard.verbs import VerbFacts


def questions(answers: object, folder: Folder) -> list[Heading]:
    """The questions that follow from these answers: an object, or the name of a file that has some."""
    return _form(answers, folder).headings


def in_a_file(verb: VerbFacts, given: Mapping[str, Any], folder: Folder) -> dict[str, Any]:
    """The arguments of a verb, where a page's answers have become a file of the folder that the verb reads."""
    name = next((one["name"] for one in verb["arguments"] if one["kind"] == "answers"), None)
    if name is None or isinstance(given.get(name), str):
        return dict(given)
    form = _form(given.get(name, {}), folder)  # without any, all is as usual
    form.require_sound()
    out = given.get("out")
    stem = PurePath(out if isinstance(out, str) and out else "arm.toml").with_suffix("")
    file = folder.new_name(f"{stem}.answers.toml")
    write_text(folder.inside(file), answers_toml(form.answers))
    return {**given, name: file}


def _form(answers: object, folder: Folder) -> ArmForm:
    if isinstance(answers, str):
        return ArmForm(answers_in(folder.file(answers)))
    if not isinstance(answers, Mapping):
        raise BadUsage("answers must be an object, or the name of a file of answers.")
    return ArmForm(answers)
