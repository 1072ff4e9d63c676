"""Makes all generated files of the repository: `python -m tools.generate [--check]`.

With --check nothing is written; stale files are named and the exit code is 1.
"""

from __future__ import annotations

import argparse
import sys

from tools.generate import files, flash, host_types, joint_pictures, limits
from tools.generate.link.__main__ import main as generate_link

GENERATORS = (generate_link, files.main, flash.main, host_types.main, limits.main, joint_pictures.main)


def main(arguments: list[str]) -> int:
    parser = argparse.ArgumentParser(description="Makes all generated files.")
    parser.add_argument("--check", action="store_true", help="write nothing; exit 1 when a file is stale")
    options = parser.parse_args(arguments)
    return max(generate(["--check"] if options.check else []) for generate in GENERATORS)


if __name__ == "__main__":
    sys.exit(main(sys.argv[1:]))
