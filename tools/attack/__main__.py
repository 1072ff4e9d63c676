"""Attack the whole project at scale and publish the counts.

python -m tools.attack [PART ...] [--share 1.0] [--workers N] [--minutes M] [--out build/attack] [--add FOLDER]
                         [--publish]

A run that was interrupted, or that has ended after its minutes, goes on where it stopped. So a long part can be done in
pieces: `soak --share 12 --minutes 30` again and again comes to 24 hours. `--add` takes over the pieces that another
machine has done for the same state of the code. `--publish` writes docs/reliability.md, which says how far each part is
and counts what was done beyond the full size; with `--minutes 0` it only adds up. The exit code is 1 when anything was
violated.
"""

from __future__ import annotations

import argparse
import math
import os
import sys
from pathlib import Path

from tools import ROOT
from tools.attack.journal import Journal
from tools.attack.page import write_page, write_table
from tools.attack.parts import PARTS
from tools.attack.runner import Work, do_all


def main(arguments: list[str]) -> int:
    names = {part.name: part for part in PARTS}
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("part", nargs="*", help=", ".join(names))
    parser.add_argument("--share", type=float, default=1.0, help="of the full number of trials")
    parser.add_argument("--workers", type=int, default=os.cpu_count())
    parser.add_argument("--minutes", type=float, default=math.inf, help="begin no other piece after them")
    parser.add_argument("--out", type=Path, default=ROOT / "build/attack")
    parser.add_argument("--add", type=Path, action="append", default=[], metavar="FOLDER", help="another --out")
    parser.add_argument("--publish", action="store_true", help="write docs/reliability.md")
    options = parser.parse_args(arguments)
    if unknown := [name for name in options.part if name not in names]:
        parser.error(f"there is no part {', '.join(unknown)}; there are {', '.join(names)}")
    if options.publish and (options.part or options.share != 1.0):
        parser.error("only all attacks together can be published")
    parts = [names[name] for name in options.part] or PARTS
    works = [Work(part, part.pieces(options.share), Journal(options.out, part)) for part in parts]
    for folder in options.add:
        taken = sum(work.journal.take_over(folder) for work in works)
        print(f"{folder}: {taken} pieces taken over")
    try:
        do_all(works, options.workers, 60 * options.minutes, tell)
    finally:
        print()
        results = [work.result() for work in works]
        for result in results:
            print(f"{result.part.title}: {result.done} of {result.pieces} pieces\n\n{write_table(result.rows)}")
    if options.publish:
        (ROOT / "docs/reliability.md").write_text(write_page(results), encoding="utf-8")
    return int(any(row.violations for result in results for row in result.rows))


def tell(done: int, pieces: int, seconds: float) -> None:
    left = seconds / done * (pieces - done)
    print(f"\r{done} of {pieces} pieces, about {left / 60:.0f} min left ", end="", flush=True)


if __name__ == "__main__":
    sys.exit(main(sys.argv[1:]))
