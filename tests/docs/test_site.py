"""The site builds without a warning: every page is in a toctree, every link and every anchor leads somewhere."""

from __future__ import annotations

import html
import importlib
import re
import subprocess
import sys
from pathlib import Path

import pytest

from greywhale.cli.verbs import all_verbs
from greywhale_sim.commands import COMMANDS
from tools import ROOT


@pytest.fixture(scope="module")
def site(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """As `make docs` builds it, in a plain theme. Nothing in it names a page of the web to load from."""
    out = tmp_path_factory.mktemp("docs") / "site"
    done = subprocess.run(
        [sys.executable, "-m", "tools.docs", "--out", str(out), "--theme", "basic"],
        cwd=ROOT,
        capture_output=True,
        text=True,
        check=False,
    )
    assert done.returncode == 0, done.stderr
    assert done.stderr == ""
    return out


def read(site: Path, page: str) -> str:
    return (site / f"{page}.html").read_text(encoding="utf-8")


@pytest.mark.slow
def test_the_site_builds_without_a_warning(site: Path) -> None:
    for page in ("index", "start", "verbs/record", "api/loop", "link", "extending"):
        assert (site / f"{page}.html").is_file(), page
    assert not re.search(r"<(?:script|link|img)[^>]+(?:src|href)=.https?:", read(site, "index"))
    assert all(f">{name}" in read(site, "bench") for name in COMMANDS), "a command without a row"
    assert "excitation.rest_s" in read(site, "limits")


@pytest.mark.slow
def test_a_verb_shows_options_defaults_codes_and_schema(site: Path) -> None:
    record = html.unescape(read(site, "verbs/record"))
    for words in (
        "--save-motion",
        "10; with --excite: 20",
        "'log.csv'",
        "Exit codes: 0 done",
        "../_static/record.json",
    ):
        assert words in record, words
    pages = [*(site / "verbs").glob("*.html"), site / "json.html"]
    linked = {
        name for page in pages for name in re.findall(r'_static/([\w-]+\.json)"', page.read_text(encoding="utf-8"))
    }
    made = {path.name for path in (site / "_static").glob("*.json")}
    assert "record.json" in made
    assert linked == made


@pytest.mark.slow
def test_every_public_name_is_on_a_page(site: Path) -> None:
    """Of the packages that say what is public."""
    pages = "".join(read(site, f"api/{path.stem}") for path in (ROOT / "docs" / "api").glob("*.md"))
    source = ROOT / "host" / "src"
    packages = [
        ".".join(path.relative_to(source).parent.parts)
        for path in (source / "greywhale").rglob("__init__.py")
        if "\n__all__ = " in path.read_text(encoding="utf-8")
    ]
    assert len(packages) > 10
    missing = [
        f"{package}.{name}"
        for package in packages
        for name in importlib.import_module(package).__all__
        if not name.isupper() and f'id="{package}.{name}"' not in pages
    ]
    assert missing == []


@pytest.mark.slow
def test_a_field_shows_its_unit(site: Path) -> None:
    text = re.sub(r"<[^>]+>", "", read(site, "api/arm"))
    assert "mass: kg" in text
    assert "gravity (9.81): m/s2" in text


def test_every_verb_has_a_page() -> None:
    pages = {path.stem for path in (ROOT / "docs" / "verbs").glob("*.md")} - {"index"}
    assert pages == set(all_verbs())
