"""A Sphinx extension: what the pages do not say themselves.

Each page of a verb gets the verb's own help, its exit codes and the schema of what it prints with --json. Modules of
the API get their names as headings, classes a list of the comments behind their fields: units, shapes.
"""

from __future__ import annotations

import inspect
import re
from pathlib import Path

import click
from pydantic import BaseModel
from sphinx.application import Sphinx

from greywhale.cli.verbs import place_of
from greywhale_sim import faults
from tools.docs.made import MADE
from tools.docs.schemas import schema_name, write_schemas

CODES = "Exit codes: 0 done; 1 failed; 2 bad usage; 130 interrupted (motors off, files whole)."
OWN_CODES = {"doctor": "Exit codes: 0 nothing must be mended; 1 something must, or failed; 2 bad usage."}
HELP = """
```{{eval-rst}}
.. click:: {place}
   :prog: greywhale {verb}
   :nested: full
```
"""
SLASH = chr(92)  # a backslash
PATH = re.compile(r"PosixPath\('([^']*)'\)")
# numpy's own way of writing an array of any shape.
ARRAY = re.compile(r"~?numpy\.ndarray\[tuple\[~?(?:typing\.)?Any, \.\.\.\], ~?numpy\.dtype\[~?numpy\.(\w+)\]\]")
# A default that is limits; docs/limits.md has the values.
LIMITS = re.compile(r"\b\w+(?:Limits|Bounds)\(")
# A field of a class with a comment behind it: name, default, comment.
_TYPE = r"[^=\n\[]*(?:\[.*?\])?[^=\n\[]*?"
FIELD = re.compile(rf"^    (\w+): {_TYPE}(?: = ([^\n]+?))?  # (?!type:|noqa)([^\n]+)$", re.MULTILINE)


def add_notes(app: Sphinx, context: click.Context, lines: list[str]) -> None:
    """Add what a command's own help does not say."""
    verb = context.command_path.removeprefix("greywhale").strip()
    if isinstance(context.command, click.Group):
        return
    lines += ["", OWN_CODES.get(verb, CODES), ""]
    schema = schema_name(verb)
    lines += [f"With ``--json`` it prints one object: `{schema} <../_static/{schema}>`__.", ""]


def name_paths(app: Sphinx, context: click.Context, lines: list[str]) -> None:
    """Show a default as it is typed."""
    lines[:] = [PATH.sub(r"'\1'", line) for line in lines]


def add_help(app: Sphinx, docname: str, source: list[str]) -> None:
    """End the page of a verb with its own help, that of `sim` with its mistakes; put what is made where it belongs."""
    for marker, text in MADE.items():
        if marker in source[0]:
            source[0] = source[0].replace(marker, text())
    folder, _, verb = docname.partition("/")
    if folder == "verbs" and verb != "index":
        source[0] += f"\n{faults.markdown_table()}\n" * (verb == "sim") + HELP.format(verb=verb, place=place_of(verb))


def shorten_arrays(
    app: Sphinx, what: str, name: str, subject: object, options: object, signature: str | None, returned: str | None
) -> tuple[str | None, str | None]:
    """NDArray[float64], as the code has it, and no limit's value; nothing for limits, and for what is read from a file,
    whose fields are listed.
    """
    if inspect.isclass(subject) and (issubclass(subject, BaseModel) or name.endswith("Limits")):
        return "", None
    return _shortened(signature), _shortened(returned)


def _shortened(part: str | None) -> str | None:
    return None if part is None else without_values(ARRAY.sub(r"NDArray[\1]", part))


def without_values(signature: str) -> str:
    """A signature without what stands in the parentheses of a default that is limits."""
    while (found := LIMITS.search(signature)) is not None:
        end, depth = found.end(), 1
        while depth:
            depth += {"(": 1, ")": -1}.get(signature[end], 0)
            end += 1
        signature = f"{signature[: found.end() - 1]}{signature[end:]}"
    return signature


def add_to_docstring(app: Sphinx, what: str, name: str, subject: object, options: object, lines: list[str]) -> None:
    """Add a module's name above its text, and below a class's what the comments behind its fields say."""
    if what == "module":
        lines[:0] = [f".. rubric:: {name}", ""]
    if what == "class":
        lines += fields_of(subject)


def fields_of(subject: object) -> list[str]:
    """The fields of a class that have a comment, as a list in reStructuredText."""
    if not inspect.isclass(subject):
        return []
    try:
        text = inspect.getsource(subject)
    except (OSError, TypeError):  # an extension module, or a class that no file holds
        return []
    found = []
    for field, default, comment in FIELD.findall(text):
        given = f" (``{default}``)" if default else ""
        found.append(f"- ``{field}``{given}: {comment.replace('*', SLASH + '*').replace('|', SLASH + '|')}")
    return ["", *found, ""] if found else []


def setup(app: Sphinx) -> dict[str, bool]:
    folder = Path(app.doctreedir) / "schemas"
    write_schemas(folder)
    app.config.html_static_path = [str(folder)]
    app.connect("sphinx-click-process-epilog", add_notes)
    app.connect("sphinx-click-process-options", name_paths)
    app.connect("source-read", add_help)
    app.connect("autodoc-process-signature", shorten_arrays)
    app.connect("autodoc-process-docstring", add_to_docstring)
    return {"parallel_read_safe": True, "parallel_write_safe": True}
