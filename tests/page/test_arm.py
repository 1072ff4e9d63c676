"""The arm in three dimensions: it draws, shows the newest sample, and nothing of it is loaded before somebody looks."""

from __future__ import annotations

import io

import pytest
from PIL import Image
from playwright.sync_api import Page, expect

from tests.page.stage import Stage

pytestmark = pytest.mark.slow


def look_from(page: Page, stage: Stage, side: str) -> None:
    """Choose where to look from, and wait until the arm is drawn from there."""
    page.get_by_role("button", name=side, exact=True).click()
    tick = stage.newest().tick
    page.wait_for_function("seen => document.querySelector('.stage canvas').dataset.tick > seen", arg=tick)


def test_the_arm_is_drawn_where_the_board_says_and_leads_by_a_link_that_is_dragged(
    shared_page: Page, stage: Stage
) -> None:
    page = shared_page
    asked: list[str] = []
    page.on("request", lambda request: asked.append(request.url.rpartition("/")[2]))
    page.get_by_role("button", name="Controller").click()
    assert not any(name.startswith("scene") for name in asked)
    page.get_by_role("button", name="Bench", exact=True).click()
    expect(page.get_by_text("Default arm: solid is the follower")).to_be_visible()
    expect(page.get_by_text("Drag a link to lead")).to_be_visible()
    canvas = page.get_by_role("img", name="The arm")
    look_from(page, stage, "Side")
    picture = Image.open(io.BytesIO(canvas.screenshot())).convert("RGB")
    assert len(picture.getcolors(1 << 20) or []) > 50  # an empty canvas has one
    look_from(page, stage, "Top")
    place = canvas.bounding_box()
    assert place is not None
    # From above, the base stands in the middle, and the hand reaches to the right of it, a little below.
    x, y = place["x"] + place["width"] / 2, place["y"] + place["height"] / 2
    before = stage.newest().leader
    page.mouse.move(x + 0.28 * place["height"], y + 0.065 * place["height"])
    page.mouse.down()
    page.mouse.move(x + 0.28 * place["height"] + 60, y + 120, steps=4)
    page.mouse.up()
    stage.wait_for(lambda: any(abs(now - then) > 1000 for now, then in zip(stage.newest().leader, before, strict=True)))
