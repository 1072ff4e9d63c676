"""Drags the corners of fuzzy sets as a person does."""

from __future__ import annotations

from playwright.sync_api import Page


def drag(page: Page, corner: str, by_share: float) -> None:
    """Drag a corner by a share of the picture's width."""
    page.get_by_role("slider", name=corner, exact=True).wait_for()
    knob = page.get_by_role("slider", name=corner, exact=True).bounding_box()
    picture = page.locator("svg.sets").first.bounding_box()
    assert knob is not None
    assert picture is not None
    x, y = knob["x"] + knob["width"] / 2, knob["y"] + knob["height"] / 2
    page.mouse.move(x, y)
    page.mouse.down()
    for step in (0.3, 0.7, 1.0):
        page.mouse.move(x + step * by_share * picture["width"], y)
    page.mouse.up()


def value_of(page: Page, corner: str) -> float:
    return float(page.get_by_role("slider", name=corner, exact=True).get_attribute("aria-valuenow") or "nan")
