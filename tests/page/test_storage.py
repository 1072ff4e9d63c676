"""A browser that keeps nothing for the page: it opens, works, and opens again."""

from __future__ import annotations

import pytest
from playwright.sync_api import BrowserContext, expect

from tests.page import stage as stages
from tests.page.stage import Stage
from tests.page.storage import FORBIDDEN, FULL, NONE

pytestmark = pytest.mark.slow


@pytest.mark.parametrize("script", [FORBIDDEN, NONE, FULL], ids=["forbidden", "none", "full"])
def test_the_page_opens_takes_a_theme_and_opens_again(context: BrowserContext, stage: Stage, script: str) -> None:
    with stages.visit(context, stage, script) as visit:
        enable, theme = visit.page.locator("button.enable:enabled"), visit.page.locator("button.theme")
        enable.wait_for()
        offered = theme.inner_text()
        theme.click()
        expect(theme).not_to_have_text(offered)
        visit.page.reload()
        enable.wait_for()
