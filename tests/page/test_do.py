"""Verbs from the page: the same results and errors as in the terminal, and the page shows both."""

from __future__ import annotations

from pathlib import Path

import pytest
from playwright.sync_api import Page, expect

from greywhale.files.log import read_log
from tests.page.stage import Stage

pytestmark = pytest.mark.slow


def test_a_recording_from_the_page_is_a_log_and_its_errors_are_sentences(
    page: Page, stage: Stage, tmp_path: Path
) -> None:
    page.get_by_role("button", name="Do", exact=True).click()
    page.get_by_role("button", name="record", exact=True).click()
    page.get_by_label("out", exact=True).fill("first.csv")
    page.get_by_label("seconds", exact=True).fill("1")
    page.get_by_role("button", name="Start record").click()
    job = page.locator(".job").first
    expect(job.get_by_role("status")).to_have_text("done")
    rows = len(read_log(tmp_path / "first.csv").time)
    assert rows > 900
    expect(job.locator(".result")).to_contain_text(str(rows))
    page.get_by_role("button", name="evaluate", exact=True).click()
    page.get_by_label("logs", exact=True).fill("none.csv")
    page.get_by_role("button", name="Start evaluate").click()
    failed = page.locator(".job").first
    expect(failed.get_by_role("status")).to_have_text("failed")
    expect(failed.get_by_role("alert")).to_contain_text("none.csv")
