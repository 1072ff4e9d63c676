"""The view of the arm where graphics are missing, slow or taken away: it says so, and the page goes on."""

from __future__ import annotations

import pytest
from playwright.sync_api import BrowserContext, expect

from tests.page import stage as stages
from tests.page.stage import Stage, await_state

pytestmark = pytest.mark.slow


def _contexts(get: str) -> str:
    return f"""{{
      const usual = HTMLCanvasElement.prototype.getContext;
      HTMLCanvasElement.prototype.getContext = function (kind, ...more) {{
        if (kind.startsWith("webgl")) {get}
        return usual.call(this, kind, ...more);
      }};
    }}"""


NONE = _contexts("return null;")
FORBIDDEN = _contexts("throw new DOMException('denied', 'SecurityError');")
# A graphics processor that is not yet ready with anything until the page is told to go on.
SLOW = """{
  const usual = WebGL2RenderingContext.prototype.getSyncParameter;
  WebGL2RenderingContext.prototype.getSyncParameter = function (...asked) {
    return window.goOn ? usual.apply(this, asked) : this.UNSIGNALED;
  };
}"""
# Takes the graphics away, and gives them back.
TAKE = """canvas => {
  window.taken = canvas.getContext("webgl2").getExtension("WEBGL_lose_context");
  taken.loseContext();
}"""
GIVE_BACK = "() => taken.restoreContext()"


@pytest.mark.parametrize("script", [NONE, FORBIDDEN], ids=["none", "forbidden"])
def test_a_browser_without_webgl_says_so_and_all_else_works(context: BrowserContext, stage: Stage, script: str) -> None:
    with stages.visit(context, stage, script) as visit:
        page = visit.page
        page.locator("button.enable:enabled").wait_for()
        page.get_by_role("button", name="Bench", exact=True).click()
        expect(page.get_by_text("cannot draw in three dimensions; turn WebGL on")).to_be_visible()
        page.get_by_role("button", name="Enable").click()
        await_state(page, "following")
        page.get_by_role("button", name="Controller").click()
        expect(page.get_by_text("Control surface")).to_be_visible()


def test_a_slow_graphics_processor_holds_up_the_picture_and_not_the_page_that_drives(
    context: BrowserContext, stage: Stage
) -> None:
    with stages.visit(context, stage, SLOW) as visit:
        page = visit.page
        page.get_by_role("button", name="Enable").click()
        await_state(page, "following")
        page.get_by_role("button", name="Bench", exact=True).click()
        canvas = page.get_by_role("img", name="The arm", include_hidden=True)
        page.wait_for_function("() => document.querySelector('.stage canvas').width === 64")
        begun = stage.newest().tick
        stage.wait_for(lambda: stage.newest().tick > begun + 1000)
        await_state(page, "following")
        expect(canvas).to_be_hidden()
        page.evaluate("() => { window.goOn = true; }")
        expect(canvas).to_be_visible()
        page.locator("canvas[data-tick]").wait_for()


def test_graphics_that_are_taken_away_are_said_to_be_and_come_back(context: BrowserContext, stage: Stage) -> None:
    with stages.visit(context, stage) as visit:
        page = visit.page
        page.get_by_role("button", name="Bench", exact=True).click()
        canvas = page.locator("canvas[data-tick]")
        canvas.wait_for()
        canvas.evaluate(TAKE)
        expect(page.get_by_text("has taken the graphics of this view away")).to_be_visible()
        expect(canvas).to_be_hidden()
        page.evaluate(GIVE_BACK)
        expect(page.get_by_text("solid is the follower")).to_be_visible()
        expect(canvas).to_be_visible()
