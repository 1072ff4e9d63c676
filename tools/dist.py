"""Builds the source distribution and wheels: `python -m tools.dist [--out FOLDER] [--python PYTHON ...]`.

Each wheel is built from the source distribution, as a stranger's pip would do it. auditwheel then names
the oldest C library that it runs with, and would copy libraries into it that not every Linux has.
"""

from __future__ import annotations

import argparse
import os
import shutil
import sys
import tempfile
from pathlib import Path

from tools import ROOT
from tools.setup import venv
from tools.setup.console import SetupError, run, say

OUT = ROOT / "build" / "dist"
SDIST = "import sys; from scikit_build_core.build import build_sdist; build_sdist(sys.argv[1])"


def build_sdist(out: Path) -> Path:
    """The source distribution, in `out`."""
    run([venv.PYTHON, "-c", SDIST, out], what="The source distribution", cwd=ROOT)
    (made,) = out.glob("greywhale-*.tar.gz")
    return made


def build_wheel(sdist: Path, out: Path, python: Path = venv.PYTHON) -> Path:
    """A wheel for this machine and this Python, in `out`; another Python than .venv's fetches its own build tools."""
    own = ["--no-build-isolation"] if python == venv.PYTHON else []
    with tempfile.TemporaryDirectory() as name:
        folder = Path(name)
        pip = [str(python), "-m", "pip", "wheel", "--quiet", "--disable-pip-version-check", "--no-deps", *own]
        run([*pip, "--wheel-dir", name, str(sdist)], what=f"The wheel of {sdist.name}", env=venv.environment())
        (raw,) = folder.iterdir()
        auditwheel = [str(venv.PYTHON), "-m", "auditwheel", "repair", "--wheel-dir", str(folder / "repaired"), str(raw)]
        run(auditwheel, what=f"auditwheel repair of {raw.name}", env=venv.environment())
        (made,) = (folder / "repaired").iterdir()
        return Path(shutil.move(made, out / made.name))


def build_all(out: Path, pythons: list[Path]) -> list[Path]:
    """The source distribution, and a wheel for each Python; what was made. Older ones in `out` are removed."""
    out.mkdir(parents=True, exist_ok=True)
    for old in (*out.glob("greywhale*.whl"), *out.glob("greywhale*.tar.gz")):
        old.unlink()
    sdist = build_sdist(out)
    return [sdist, *(build_wheel(sdist, out, python) for python in pythons)]


def main() -> int:
    parser = argparse.ArgumentParser(description="Builds the source distribution and wheels.")
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
