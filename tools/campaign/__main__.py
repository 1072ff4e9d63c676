"""Attack the whole project at scale and publish the counts.

python -m tools.campaign [PART ...] [--share 1.0] [--workers N] [--out build/campaign] [--publish]

A run that was interrupted goes on where it stopped. `--publish` writes docs/reliability.md, which needs every part at
its full size. The exit code is 1 when anything was violated.
"""

from __future__ import annotations

import argparse
import os
import signal
import sys
import time
from concurrent.futures import ProcessPoolExecutor, as_completed
from pathlib import Path

from tools.campaign.journal import ROOT, Journal
from tools.campaign.page import write_page, write_table
from tools.campaign.part import Part, Piece, Row, add_up
from tools.campaign.parts import PARTS


def do_all(part: Part, pieces: list[Piece], journal: Journal, pool: ProcessPoolExecutor) -> None:
    """Do what is missing; each piece that is finished is kept at once."""
    missing = journal.missing(pieces)
    running = {pool.submit(part.run, piece): piece for piece in missing}
    began = time.monotonic()
    for number, future in enumerate(as_completed(running), 1):
        journal.add(running[future], future.result())
        left = (time.monotonic() - began) / number * (len(missing) - number)
        print(f"\r{part.name}: {number} of {len(missing)} pieces, about {left / 60:.0f} min left ", end="", flush=True)
    if missing:
        print()


def ignore_interrupts() -> None:
    """Ctrl-C reaches every process of the terminal; the first one ends the others."""
    signal.signal(signal.SIGINT, signal.SIG_IGN)


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
    with ProcessPoolExecutor(options.workers, initializer=ignore_interrupts, max_tasks_per_child=1) as pool:
        for part in [names[name] for name in options.part] or PARTS:
            pieces, journal = part.pieces(options.share), Journal(options.out, part)
            try:
                do_all(part, pieces, journal, pool)
            except KeyboardInterrupt:
                pool.shutdown(wait=False, cancel_futures=True)
                raise
            results.append((part, add_up(journal.rows(pieces))))
            print(write_table(results[-1][1]))
    if options.publish:
        (ROOT / "docs/reliability.md").write_text(write_page(results), encoding="utf-8")
    return int(any(row.violations for _, rows in results for row in rows))


if __name__ == "__main__":
    sys.exit(main(sys.argv[1:]))
