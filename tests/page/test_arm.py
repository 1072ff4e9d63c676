"""The arm in three dimensions: it draws, shows the newest sample, and nothing of it is loaded before somebody looks."""

from __future__ import annotations

import pytest
from playwright.sync_api import Page, expect

from tests.page.stage import Stage

pytestmark = pytest.mark.slow

# How many colours the picture has: a canvas on which nothing was drawn has one.
COLOURS = """canvas => new Promise(done => requestAnimationFrame(() => {
  const copy = new OffscreenCanvas(64, 64).getContext("2d");
  copy.drawImage(canvas, 0, 0, 64, 64);
  done(new Set(new Uint32Array(copy.getImageData(0, 0, 64, 64).data.buffer)).size);
}))"""


def test_the_arm_is_drawn_where_the_board_says(page: Page, stage: Stage) -> None:
    asked: list[str] = []
    page.on("request", lambda request: asked.append(request.url.rpartition("/")[2]))
    page.get_by_role("button", name="Controller").click()
    assert not any(name.startswith("scene") for name in asked)
    page.get_by_role("button", name="Arm", exact=True).click()
    expect(page.get_by_text("default arm: solid is the follower")).to_be_visible()
    canvas = page.get_by_role("img", name="The arm")
    tick = stage.samples()[-1].tick
    page.get_by_role("button", name="Side").click()
    page.wait_for_function("seen => document.querySelector('.stage canvas').dataset.tick > seen", arg=tick)
    assert canvas.evaluate(COLOURS) > 20
