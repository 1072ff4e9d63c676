"""Writes the project's one version wherever else it stands: `python -m tools.generate.version [--check] [NEW]`.

The version is the one of pyproject.toml. NEW writes another one there first. With --check nothing is written; files
that differ are named and the exit code is 1. `greywhale --version` reads the installed package.
"""

from __future__ import annotations

import argparse
import re
import sys
from dataclasses import dataclass
from pathlib import Path

from tools import ROOT

SOURCE = "pyproject.toml"
NUMBERS = re.compile(r"(\d{1,3})\.(\d{1,3})\.(\d{1,3})")  # the firmware reports three bytes


@dataclass(frozen=True)
class Copy:
    """A place that repeats the version: the text before it, as a pattern, and how the version is written there."""

    file: str
    before: str
    form: str = "{0}.{1}.{2}"

    def pattern(self) -> re.Pattern[str]:
        written = re.escape(self.form).replace(r"\{0\}", r"\d+").replace(r"\{1\}", r"\d+").replace(r"\{2\}", r"\d+")
        return re.compile(f"({self.before})({written})", re.MULTILINE)


COPIES = (
    Copy(
        "firmware/lib/app/src/version.h",
        "constexpr uint8_t ",
        "version_major = {0}, version_minor = {1}, version_patch = {2}",
    ),
    Copy("sim/pyproject.toml", '^version = "'),
    Copy("sim/pyproject.toml", '"greywhale=='),
    Copy("CITATION.cff", "^version: "),
)


class VersionError(Exception):
    """One sentence: which file, and what is wrong with it."""


def read_version(root: Path) -> str:
    """The version of the package, three numbers."""
    found = re.search(r'^version = "([^"]*)"', (root / SOURCE).read_text(encoding="utf-8"), re.MULTILINE)
    if found is None or not NUMBERS.fullmatch(found[1]):
        raise VersionError(f'{SOURCE}: there is no line version = "MAJOR.MINOR.PATCH".')
    return found[1]


def updated_texts(root: Path, version: str) -> dict[str, str]:
    """File -> text with this version, for every file that repeats it."""
    texts: dict[str, str] = {}
    for copy in COPIES:
        text = texts.get(copy.file) or (root / copy.file).read_text(encoding="utf-8")
        wanted = copy.form.format(*version.split("."))
        text, count = copy.pattern().subn(rf"\g<1>{wanted}", text)
        if count != 1:
            raise VersionError(f"{copy.file}: {count} places match {copy.before!r} with a version; there must be one.")
        texts[copy.file] = text
    return texts


def stale_files(root: Path) -> list[str]:
    """The files whose version is not that of pyproject.toml."""
    texts = updated_texts(root, read_version(root))
    return [file for file, text in texts.items() if (root / file).read_text(encoding="utf-8") != text]


def write_version(root: Path, version: str) -> None:
    """Make `version` the version of everything."""
    if not NUMBERS.fullmatch(version):
        raise VersionError(f"{version}: a version has three numbers, for example 1.0.0.")
    texts = updated_texts(root, version)
    source = (root / SOURCE).read_text(encoding="utf-8")
    texts[SOURCE] = re.sub(r'^(version = ")[^"]*', rf"\g<1>{version}", source, count=1, flags=re.MULTILINE)
    for file, text in texts.items():
        (root / file).write_text(text, encoding="utf-8")


def main(arguments: list[str] | None = None) -> int:
    parser = argparse.ArgumentParser(description="Writes the version of pyproject.toml wherever else it stands.")
    parser.add_argument("new", nargs="?", metavar="NEW", help="another version, written into pyproject.toml first")
    parser.add_argument("--check", action="store_true", help="write nothing; exit 1 when a file differs")
    parser.add_argument("--root", type=Path, default=ROOT, help="the repository (default: this one)")
    options = parser.parse_args(arguments)
    if options.check and options.new:
        parser.error("--check and NEW exclude each other")
    try:
        if options.check:
            stale = stale_files(options.root)
            for file in stale:
                print(f"{file} has another version than {SOURCE}; run `make docs`.", file=sys.stderr)
            return 1 if stale else 0
        write_version(options.root, options.new or read_version(options.root))
    except VersionError as error:
        print(error, file=sys.stderr)
        return 1
    return 0


if __name__ == "__main__":
    raise SystemExit(main())
