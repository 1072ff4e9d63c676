"""Makes everything that is derived from shared/link/*.toml: `python -m tools.generate.link [--check]`.

The declarations become a C++ header of messages, the firmware's parameter table, the host's Python module, the
page's TypeScript module, the reference page, and golden vectors and a list of messages for the tests. With --check
nothing is written; stale files are named and the exit code is 1.
Needs nothing but Python 3.11.
"""

from __future__ import annotations

import argparse
import sys
from pathlib import Path

from tools import ROOT
from tools.generate.link import cpp_codes, cpp_messages, cpp_parameters, golden, page, python_module, typescript
from tools.generate.link.declaration import Declaration, DeclarationError, load


def outputs(declaration: Declaration) -> dict[str, str]:
    """Path below the root -> text of every generated file."""
    return {
        "firmware/lib/codes/src/codes/codes.h": cpp_codes.header(declaration),
        "firmware/lib/link/src/link/schema.h": cpp_messages.header(declaration),
        "firmware/lib/params/src/params/table.h": cpp_parameters.header(declaration),
        "firmware/lib/params/src/params/table.cpp": cpp_parameters.source(declaration),
        "firmware/test/native/messages.h": cpp_messages.visitor(declaration),
        "host/src/greywhale/protocol/schema.py": python_module.module(declaration),
        "host/web/src/link/schema.ts": typescript.module(declaration),
        "shared/link/golden.toml": golden.toml(declaration),
        "docs/link.md": page.page(declaration),
    }


def stale_files(root: Path, texts: dict[str, str]) -> list[str]:
    """The files that are missing or differ from what the declarations give."""
    return [path for path, text in texts.items() if not _holds(root / path, text)]


def _holds(path: Path, text: str) -> bool:
    return path.is_file() and path.read_text(encoding="utf-8") == text


def main(arguments: list[str] | None = None) -> int:
    parser = argparse.ArgumentParser(description="Generates the link's code, page and golden vectors from shared/link.")
    parser.add_argument("--check", action="store_true", help="write nothing; exit 1 when a file is stale")
    parser.add_argument("--root", type=Path, default=ROOT, help="the repository (default: this one)")
    options = parser.parse_args(arguments)
    try:
        texts = outputs(load(options.root / "shared" / "link"))
    except DeclarationError as error:
        print(error, file=sys.stderr)
        return 1
    stale = stale_files(options.root, texts)
    if options.check:
        for path in stale:
            print(f"{path} does not match shared/link; run `python -m tools.generate.link`.", file=sys.stderr)
        return 1 if stale else 0
    for path in stale:
        target = options.root / path
        target.parent.mkdir(parents=True, exist_ok=True)
        target.write_text(texts[path], encoding="utf-8")
        print(f"wrote {path}")
    return 0


if __name__ == "__main__":
    raise SystemExit(main())
