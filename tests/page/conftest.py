"""One browser for all tests of the page, and a stage and a page for each."""

from __future__ import annotations

from collections.abc import Iterator
from pathlib import Path

import pytest
from playwright.sync_api import Browser, Page

from tests.page import stage as stages
from tests.page.stage import Stage


@pytest.fixture(scope="session")
def browser() -> Iterator[Browser]:
    with stages.browser() as running:
        yield running


@pytest.fixture
def stage(tmp_path: Path) -> Iterator[Stage]:
    """The server around a bench, with a folder of its own."""
    made = Stage(tmp_path)
    with made.open():
        yield made


@pytest.fixture
def page(browser: Browser, stage: Stage) -> Iterator[Page]:
    """A page that drives, at rest."""
    context = browser.new_context(viewport={"width": 1280, "height": 900}, accept_downloads=True)
    with stages.visit(context, stage) as visit:
        visit.page.locator("button.enable:enabled").wait_for()
        yield visit.page
    context.close()
