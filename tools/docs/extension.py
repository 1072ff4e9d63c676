"""A Sphinx extension: what the pages do not say themselves.

Below the options of every verb it adds the exit codes and the schema of what the verb prints with --json. In a toctree
a page with a question mark, `study?`, may be missing.
"""

from __future__ import annotations

import re
from pathlib import Path

import click
from sphinx.application import Sphinx

from tools.docs.schemas import SCHEMAS, schema_name

CODES = "Exit codes: 0 done; 1 failed; 2 bad usage; 130 interrupted (motors off, files whole)."
OWN_CODES = {"doctor": "Exit codes: 0 nothing must be mended; 1 something must, or failed; 2 bad usage."}
OPTIONAL = re.compile(r"^([\w-]+)\?\n", re.MULTILINE)


def add_notes(app: Sphinx, context: click.Context, lines: list[str]) -> None:
    """Add what a command's own help does not say."""
    verb = context.command_path.removeprefix("greywhale").strip()
    if isinstance(context.command, click.Group):
        return
    lines += ["", OWN_CODES.get(verb, CODES), ""]
    schema = schema_name(verb)
    if (SCHEMAS / schema).exists():
        lines += [f"With ``--json`` it prints one object: `{schema} <../_static/{schema}>`__.", ""]


def keep_pages(app: Sphinx, docname: str, source: list[str]) -> None:
    """Leave out pages that may be missing and are."""
    source[0] = OPTIONAL.sub(
        lambda found: f"{found[1]}\n" if (Path(app.srcdir) / f"{found[1]}.md").exists() else "", source[0]
    )


def setup(app: Sphinx) -> dict[str, bool]:
    app.connect("sphinx-click-process-epilog", add_notes)
    app.connect("source-read", keep_pages)
    return {"parallel_read_safe": True, "parallel_write_safe": True}
