"""Attack the whole project at scale and publish the counts.

python -m tools.attack [PART ...] [--share 1.0] [--workers N] [--out build/attack] [--publish]

A run that was interrupted goes on where it stopped. `--publish` writes docs/reliability.md. The exit code is 1 when
anything was violated.
"""

from __future__ import annotations

import argparse
import sys
from pathlib import Path

from tools import ROOT
from tools.attack.page import write_page, write_table
from tools.attack.parts import PARTS
from tools.attack.run import attack


def main(arguments: list[str]) -> int:
    names = {part.name: part for part in PARTS}
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("part", nargs="*", help=", ".join(names))
    parser.add_argument("--share", type=float, default=1.0, help="of the full number of trials")
    parser.add_argument("--workers", type=int, help="processes; without it, one for every processor")
    parser.add_argument("--out", type=Path, default=ROOT / "build/attack")
    parser.add_argument("--publish", action="store_true", help="write docs/reliability.md")
    options = parser.parse_args(arguments)
    if unknown := [name for name in options.part if name not in names]:
        parser.error(f"there is no part {', '.join(unknown)}; there are {', '.join(names)}")
    if options.publish and (options.part or options.share != 1.0):
        parser.error("only all attacks together can be published")
    results = []
    for name in options.part or names:
        results.append(attack(names[name], options.share, options.workers, options.out, tell))
        print(f"\n{names[name].title}\n\n{write_table(results[-1].rows)}", flush=True)
    if options.publish:
        (ROOT / "docs/reliability.md").write_text(write_page(results), encoding="utf-8")
    return int(any(row.violations for result in results for row in result.rows))


def tell(what: str, share: float) -> None:
    if sys.stderr.isatty():
        print(f"\r{what}: {share:.0%}", end="", file=sys.stderr, flush=True)


if __name__ == "__main__":
    sys.exit(main(sys.argv[1:]))
