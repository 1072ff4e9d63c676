"""The site builds without a warning: every page is in a toctree, every link and every anchor leads somewhere."""

from __future__ import annotations

import subprocess
import sys
from pathlib import Path

import pytest

from greywhale.cli.verbs import VERBS
from tools.docs.site import ROOT


@pytest.mark.slow
def test_the_site_builds_without_a_warning(tmp_path: Path) -> None:
    """As `make docs` builds it, without a network."""
    command = [sys.executable, "-m", "tools.docs", "--out", str(tmp_path / "site")]
    done = subprocess.run(command, cwd=ROOT, capture_output=True, text=True, check=False)
    assert done.returncode == 0, done.stderr
    assert done.stderr == ""
    for page in ("index", "start", "verbs/record", "api/loop", "link", "extending"):
        assert (tmp_path / "site" / f"{page}.html").is_file(), page
    record = (tmp_path / "site" / "verbs" / "record.html").read_text(encoding="utf-8")
    for words in ("--save-motion", "10; with --excite: 20", "Exit codes: 0 done"):
        assert words in record


def test_every_verb_has_a_page() -> None:
    pages = {path.stem for path in (ROOT / "docs" / "verbs").glob("*.md")} - {"index"}
    assert pages == set(VERBS)
