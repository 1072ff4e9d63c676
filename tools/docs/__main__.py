"""`python -m tools.docs [--out DIR] [--theme NAME]`: builds the site; a warning is an error, and nothing is fetched.

With --external the links to the web are listed instead, for whoever has a network to try them.
"""

from __future__ import annotations

import argparse
import sys
from pathlib import Path

from tools import ROOT
from tools.docs.links import links, pages
from tools.docs.site import SITE, build


def main() -> int:
    parser = argparse.ArgumentParser(prog="python -m tools.docs", description="Build the site from docs/.")
    parser.add_argument("--out", type=Path, default=SITE, help="where it goes (default: build/site)")
    parser.add_argument("--external", action="store_true", help="list the links to the web, and build nothing")
    parser.add_argument("--theme", default="", help="another theme than the site's")
    options = parser.parse_args()
    if options.external:
        for link in (link for page in pages() for link in links(page) if link.is_external):
            print(f"{link.page.relative_to(ROOT)}: {link.target}")
        return 0
    code = build(options.out, theme=options.theme)
    if code == 0:
        print(f"The site is in {options.out / 'index.html'}.")
    return code


if __name__ == "__main__":
    sys.exit(main())
