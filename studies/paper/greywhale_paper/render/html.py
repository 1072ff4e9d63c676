"""The report as one HTML file that needs no other: pictures are inside."""

from __future__ import annotations

import base64
from pathlib import Path

import jinja2

from greywhale.base.formats.whole import write_text
from greywhale_paper.pages.document import Document, Picture
from greywhale_paper.pages.numbers import keep_ranges


def write_html(document: Document, path: Path) -> Path:
    """Write the page, whole or not at all."""
    environment = jinja2.Environment(
        loader=jinja2.PackageLoader("greywhale_paper", "data"),
        autoescape=True,
        undefined=jinja2.StrictUndefined,
        trim_blocks=True,
        lstrip_blocks=True,
    )
    page = environment.get_template("report.html")
    write_text(
        path, page.render(document=document, kind=lambda block: type(block).__name__, url=_url, keep=keep_ranges)
    )
    return path


def _url(picture: Picture) -> str:
    return "data:image/png;base64," + base64.b64encode(picture.png).decode("ascii")
