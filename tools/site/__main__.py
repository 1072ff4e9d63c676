"""`make site`: the page with a bench inside, in build/try, and the documentation beside it."""

from __future__ import annotations

import shutil
import sys

from tools import ROOT
from tools.docs import __main__ as docs
from tools.setup.console import SetupError, say
from tools.site.build import build

FOLDER = ROOT / "build" / "try"


def main() -> int:
    try:
        build(FOLDER)
    except SetupError as error:
        print(f"site: {error}", file=sys.stderr)
        return 1
    if code := docs.build(docs.SITE, theme=""):
        return code
    shutil.copytree(docs.SITE, FOLDER / "docs")
    say(f"the page is in {FOLDER}; any web server can hand it out, such as python3 -m http.server --directory {FOLDER}")
    return 0


if __name__ == "__main__":
    sys.exit(main())
