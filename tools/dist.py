"""Builds both packages, source distributions and wheels: `python -m tools.dist [--out FOLDER] [--python PYTHON ...]`.

Each wheel is built from its source distribution, as a stranger's pip would do it. Of greywhale's, auditwheel then names
the oldest C library that it runs with, and would copy libraries into it that not every Linux has. greywhale-paper is
Python alone: one wheel serves all.
"""

from __future__ import annotations

import argparse
import os
import shutil
import sys
import tempfile
from pathlib import Path

from tools import ROOT
from tools.setup import paper, venv
from tools.setup.console import SetupError, run, say

OUT = ROOT / "build" / "dist"
FOR_ALL = "-py3-none-any.whl"  # the name of a wheel for every Python and every machine
SDIST = "import sys; from scikit_build_core.build import build_sdist; build_sdist(sys.argv[1])"


def build_sdist(package: str, source: Path, out: Path) -> Path:
    """The source distribution of a package, in `out`."""
    run([venv.PYTHON, "-c", SDIST, out], what=f"The source distribution of {package}", cwd=source)
    (made,) = out.glob(f"{package}-*.tar.gz")
    return made


def build_wheel(sources: Path, out: Path, python: Path = venv.PYTHON, kept: Path | None = None) -> Path:
    """A wheel for this machine and this Python, in `out`; another Python than .venv's fetches its own build tools.

    From a source distribution, or from a folder with what one holds. What is compiled stays in the folder `kept`.
    """
    own = ["--no-build-isolation"] if python == venv.PYTHON else []
    own += [f"--config-settings=build-dir={kept}"] if kept else []
    with tempfile.TemporaryDirectory() as name:
        folder = Path(name)
        pip = [str(python), "-m", "pip", "wheel", "--quiet", "--disable-pip-version-check", "--no-deps", *own]
        run([*pip, "--wheel-dir", name, str(sources)], what=f"The wheel of {sources.name}", env=venv.environment())
        (made,) = folder.iterdir()
        if not made.name.endswith(FOR_ALL):
            repaired = folder / "repaired"
            auditwheel = [str(venv.PYTHON), "-m", "auditwheel", "repair", "--wheel-dir", str(repaired), str(made)]
            run(auditwheel, what=f"auditwheel repair of {made.name}", env=venv.environment())
            (made,) = repaired.iterdir()
        return Path(shutil.move(made, out / made.name))


def build_greywhale(out: Path, pythons: list[Path]) -> list[Path]:
    """The source distribution, and a wheel for each Python."""
    sdist = build_sdist("greywhale", ROOT, out)
    return [sdist, *(build_wheel(sdist, out, python) for python in pythons)]


def build_paper(out: Path) -> list[Path]:
    """The source distribution of greywhale-paper, and its wheel."""
    sdist = build_sdist("greywhale_paper", paper.FOLDER, out)
    return [sdist, build_wheel(sdist, out)]


def build_all(out: Path, pythons: list[Path]) -> list[Path]:
    """Both packages; what was made. Older ones in `out` are removed."""
    out.mkdir(parents=True, exist_ok=True)
    for old in (*out.glob("greywhale*.whl"), *out.glob("greywhale*.tar.gz")):
        old.unlink()
    return [*build_greywhale(out, pythons), *build_paper(out)]


def main() -> int:
    parser = argparse.ArgumentParser(description="Builds source distributions and wheels of both packages.")
    parser.add_argument("--out", type=Path, default=OUT, help="folder for them (default: build/dist)")
    parser.add_argument("--python", type=Path, action="append", help="build for this Python; may be repeated")
    options = parser.parse_args()
    pythons = [Path(os.path.abspath(python)) for python in options.python or [venv.PYTHON]]
    try:
        for path in build_all(options.out.resolve(), pythons):
            say(f"{path.name}, {path.stat().st_size // 1024} kB")
    except SetupError as error:
        print(error, file=sys.stderr)
        return 1
    return 0


if __name__ == "__main__":
    sys.exit(main())
