"""The page with a bench inside, in a browser that keeps nothing or is full: it opens, and a sentence tells."""

from __future__ import annotations

import pytest
from playwright.sync_api import BrowserContext, Page, expect

from tests.page import stage as stages
from tests.page.drag import drag
from tests.page.site.serve_folder import Site
from tests.page.stage import await_state
from tests.page.storage import FORBIDDEN, NONE

pytestmark = pytest.mark.slow

KEPT, ASIDE = "greywhale-eeprom-mega", "greywhale-eeprom-damaged"
# Damaged content, with room beside it for so many letters. What is large gets an entry of its own: with each change of
# an entry all of it goes to another process.
FILL = """([key, text, room]) => {
  localStorage.clear();
  localStorage.setItem(key, text);
  let rest = "";
  for (let size = 1 << 23; size; size >>= 1) {
    try {
      if (size < 1024) localStorage.setItem("rest", (rest = rest + "x".repeat(size)));
      else localStorage.setItem(`${size}`, "x".repeat(size));
    } catch {
      rest = localStorage.getItem("rest") ?? "";
    }
  }
  localStorage.setItem("rest", rest.slice(room));
}"""
# It is filled between two pages: one that runs keeps its own board's memory there.
AT_ITS_START = f"""{{
  const asked = sessionStorage.getItem("fill");
  sessionStorage.removeItem("fill");
  if (asked) ({FILL})(JSON.parse(asked));
}}"""


def store_something(page: Page) -> None:
    page.get_by_role("button", name="Stop").click()
    page.get_by_role("button", name="Controller", exact=True).click()
    drag(page, "Pe_b", 0.1)
    page.get_by_role("button", name="Apply").click()
    expect(page.get_by_text("The board runs these controllers.")).to_be_visible()
    page.get_by_role("button", name="Store").click()
    expect(page.get_by_text("The board has stored these controllers.")).to_be_visible()


@pytest.mark.parametrize("script", [FORBIDDEN, NONE], ids=["forbidden", "none"])
def test_a_browser_that_keeps_nothing(context: BrowserContext, site: Site, script: str) -> None:
    with stages.visit(context, site, script) as visit:
        page = visit.page
        expect(page.locator(".notice")).to_contain_text("This browser keeps nothing for this page")
        await_state(page, "following")
        theme = page.locator("button.theme")
        offered = theme.inner_text()
        theme.click()
        expect(theme).not_to_have_text(offered)
        store_something(page)


def test_a_damaged_copy_is_not_lost_in_a_full_storage(context: BrowserContext, site: Site) -> None:
    with stages.visit(context, site, AT_ITS_START) as visit:
        page = visit.page
        for room, words, key in ((8, "it is set aside", ASIDE), (0, "without room to set it aside", KEPT)):
            page.evaluate("(asked) => sessionStorage.setItem('fill', JSON.stringify(asked))", [KEPT, "no memory", room])
            page.reload()
            expect(page.locator(".notice")).to_contain_text(words)
            await_state(page, "following")
            assert page.evaluate("(key) => localStorage.getItem(key)", key) == "no memory"
        store_something(page)
        expect(page.locator(".notice")).to_contain_text("no room to keep what the board stores")
