"""Attack the whole project at scale and publish the counts.

python -m tools.campaign [PART ...] [--share 1.0] [--workers N] [--out build/campaign] [--publish]

A run that was interrupted goes on where it stopped. `--publish` writes docs/reliability.md, which needs every part at
its full size. The exit code is 1 when anything was violated.
"""

from __future__ import annotations

import argparse
import os
import sys
from pathlib import Path

from tools.campaign.journal import ROOT, Journal
from tools.campaign.page import write_page, write_table
from tools.campaign.part import Part, Row, add_up
from tools.campaign.parts import PARTS
from tools.campaign.runner import do_all, open_pool


def main(arguments: list[str]) -> int:
    names = {part.name: part for part in PARTS}
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("part", nargs="*", help=", ".join(names))
    parser.add_argument("--share", type=float, default=1.0, help="of the full number of trials")
    parser.add_argument("--workers", type=int, default=os.cpu_count())
    parser.add_argument("--out", type=Path, default=ROOT / "build/campaign")
    parser.add_argument("--publish", action="store_true", help="write docs/reliability.md")
    options = parser.parse_args(arguments)
    if unknown := [name for name in options.part if name not in names]:
        parser.error(f"there is no part {', '.join(unknown)}; there are {', '.join(names)}")
    if options.publish and (options.part or options.share != 1.0):
        parser.error("only the whole campaign at its full size can be published")
    results: list[tuple[Part, list[Row]]] = []
    with open_pool(options.workers) as pool:
        for part in [names[name] for name in options.part] or PARTS:
            pieces, journal = part.pieces(options.share), Journal(options.out, part)
            do_all(part, pieces, journal, pool)
            results.append((part, add_up(journal.rows(pieces))))
            print(write_table(results[-1][1]))
    if options.publish:
        (ROOT / "docs/reliability.md").write_text(write_page(results), encoding="utf-8")
    return int(any(row.violations for _, rows in results for row in rows))


if __name__ == "__main__":
    sys.exit(main(sys.argv[1:]))
