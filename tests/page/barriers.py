"""What could bar a person from a page, as axe finds it."""

from __future__ import annotations

import re
from typing import Literal

from playwright.sync_api import Page

from tools import ROOT

Look = tuple[Literal["light", "dark"], int]  # theme, width in pixels

LIGHT_AND_WIDE: Look = ("light", 1280)
DARK_AND_NARROW: Look = ("dark", 390)


def require_no_barrier(page: Page, *looks: Look, views: str = "") -> None:
    """axe finds nothing serious in any view, or in those whose names match, and nothing lies beyond the screen."""
    page.evaluate((ROOT / "host/web/node_modules/axe-core/axe.min.js").read_text("utf-8"))
    for theme, width in looks:
        page.emulate_media(color_scheme=theme, reduced_motion="reduce")
        page.set_viewport_size({"width": width, "height": 800})
        for tab in page.locator("nav button", has_text=re.compile(views)).all():
            tab.click()
            found = page.evaluate("axe.run({ resultTypes: ['violations'] }).then(({violations}) => violations)")
            serious = [one["id"] for one in found if one["impact"] in ("serious", "critical")]
            assert serious == [], f"{tab.inner_text()}, {theme}, {width} px"
            assert page.evaluate("document.documentElement.scrollWidth") <= width, tab.inner_text()
