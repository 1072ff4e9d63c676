"""Builds the site with Sphinx; every warning is an error."""

from __future__ import annotations

import gc
import sys
from pathlib import Path

from sphinx.cmd.build import build_main

from tools import ROOT

SITE = ROOT / "build" / "site"


def build(out: Path, builder: str = "html", theme: str = "") -> int:
    """Build the pages of docs/ into a folder; Sphinx's exit code. Another theme than the site's builds faster."""
    gc.disable()  # trees of nodes live to the end; to look for dead ones takes a third of the build
    sys.path.insert(0, str(ROOT))  # settings and extension are modules of tools
    doctrees = ["-d", str(out.parent / f"{out.name}-doctrees")]
    other = ["-D", f"html_theme={theme}"] if theme else []
    where = [str(ROOT / "docs"), str(out)]
    return build_main(["-b", builder, "-W", "--keep-going", "-q", "-E", *other, *doctrees, *where])
