"""`python -m tools.docs [--out DIR] [--theme NAME]`: builds the site with Sphinx; a warning is an error."""

from __future__ import annotations

import argparse
import gc
import sys
from pathlib import Path

from sphinx.cmd.build import build_main

from tools import ROOT

SITE = ROOT / "build" / "site"


def build(out: Path, theme: str) -> int:
    """Build the pages of docs/ into a folder; Sphinx's exit code. Another theme than the site's builds faster."""
    gc.disable()  # trees of nodes live to the end; to look for dead ones takes a third of the build
    sys.path.insert(0, str(ROOT))  # settings and extension are modules of tools
    doctrees = ["-d", str(out.parent / f"{out.name}-doctrees")]
    other = ["-D", f"html_theme={theme}"] if theme else []
    where = [str(ROOT / "docs"), str(out)]
    return build_main(["-b", "html", "-W", "--keep-going", "-q", "-E", *other, *doctrees, *where])


def main() -> int:
    parser = argparse.ArgumentParser(prog="python -m tools.docs", description="Build the site from docs/.")
    parser.add_argument("--out", type=Path, default=SITE, help="where it goes (default: build/site)")
    parser.add_argument("--theme", default="", help="another theme than the site's")
    options = parser.parse_args()
    code = build(options.out, options.theme)
    if code == 0:
        print(f"The site is in {options.out / 'index.html'}.")
    return code


if __name__ == "__main__":
    sys.exit(main())
