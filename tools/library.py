"""The controller as a library of Arduino's and PlatformIO's registries: `python -m tools.library FOLDER URL`.

The folder is what the root of the library's repository must hold; URL is where that repository is. Sources are taken
from firmware/lib, and the version from pyproject.toml: whoever publishes the folder tags it with that version.
"""

from __future__ import annotations

import json
import shutil
import sys
import tomllib
from pathlib import Path

from greywhale.files.fis import parse
from greywhale.fuzzy.export_header import make_header
from greywhale.fuzzy.table_law import from_fis
from tools import ROOT
from tools.support.fis_files import table

NAME = "GreywhaleFuzzy"
WRITTEN = ROOT / "firmware" / "library"
SOURCES = {"fuzzy_pdi": ROOT / "firmware/lib/fuzzy_pdi/src", "codes": ROOT / "firmware/lib/codes/src/codes"}
AUTHOR = "The greywhale authors"
SENTENCE = "A fuzzy PD+I controller in integers: no heap, no float, no windup."
PARAGRAPH = (
    "3 x 3 rules in about 500 cycles on an ATmega, within 1/32768 of the exact law (proven), with the same bits on"
    " other chips and on a PC. Larger tables come as one header from a .fis of MATLAB or Octave."
)


def tree(url: str) -> dict[str, str]:
    """Every file by its path from the root, and its text."""
    version = tomllib.loads((ROOT / "pyproject.toml").read_text(encoding="utf-8"))["project"]["version"]
    files = {
        f"src/{name}/{path.name}": path.read_text(encoding="utf-8")
        for name, folder in SOURCES.items()
        for path in sorted(folder.iterdir())
    }
    files[f"src/{NAME}.h"] = (WRITTEN / f"{NAME}.h").read_text(encoding="utf-8")
    for path in sorted(WRITTEN.rglob("*")):
        if path.is_file() and path.suffix != ".h":
            files[path.relative_to(WRITTEN).as_posix()] = path.read_text(encoding="utf-8")
    fis = table(5)
    files["extras/law.fis"] = fis
    files["examples/OwnTable/law.h"] = make_header(from_fis(parse(fis), "law.fis"), "law.fis", "law.h").text
    files["LICENSE"] = (ROOT / "LICENSE").read_text(encoding="utf-8")
    files["library.properties"] = _properties(version, url)
    files["library.json"] = json.dumps(_manifest(version, url), indent=2) + "\n"
    return files


def _properties(version: str, url: str) -> str:
    fields = {
        "name": NAME,
        "version": version,
        "author": AUTHOR,
        "maintainer": AUTHOR,
        "sentence": SENTENCE,
        "paragraph": PARAGRAPH,
        "category": "Device Control",
        "url": url,
        "architectures": "*",
        "includes": f"{NAME}.h",
        "license": "Apache-2.0",
    }
    return "".join(f"{key}={value}\n" for key, value in fields.items())


def _manifest(version: str, url: str) -> dict[str, object]:
    return {
        "name": NAME,
        "version": version,
        "description": f"{SENTENCE} {PARAGRAPH}",
        "keywords": ["fuzzy", "pid", "controller", "motor", "fixed point"],
        "authors": [{"name": AUTHOR, "maintainer": True}],
        "repository": {"type": "git", "url": url},
        "license": "Apache-2.0",
        "headers": f"{NAME}.h",
        "frameworks": "*",
        "platforms": "*",
    }


def write(folder: Path, url: str) -> None:
    """Write the tree anew; a folder of anything else is left alone."""
    if folder.exists() and not (folder / "library.properties").exists():
        raise SystemExit(f"{folder}: is there already and is no library; name another folder.")
    fresh = folder.with_name(folder.name + ".new")
    shutil.rmtree(fresh, ignore_errors=True)
    for name, text in tree(url).items():
        (fresh / name).parent.mkdir(parents=True, exist_ok=True)
        (fresh / name).write_text(text, encoding="utf-8")
    shutil.rmtree(folder, ignore_errors=True)
    fresh.rename(folder)


if __name__ == "__main__":
    if len(sys.argv) != 3:
        raise SystemExit(__doc__)
    write(Path(sys.argv[1]), sys.argv[2])
