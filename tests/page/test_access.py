"""An address opens the page once, which lets its own browser in again, and no file of a browser keeps the token."""

from __future__ import annotations

from functools import partial
from pathlib import Path

import pytest
from playwright.sync_api import Browser, BrowserContext, Page, expect

from greywhale.dashboard import server
from tests.page import stage as stages
from tests.page.stage import CHROMIUM, FLAGS, Stage

pytestmark = pytest.mark.slow


def browser_of(context: BrowserContext) -> Browser:
    assert context.browser is not None
    return context.browser


def require_refused(page: Page, address: str, sentence: str) -> None:
    page.goto(address)
    expect(page.locator(".empty")).to_contain_text(sentence)
    expect(page.locator(".empty")).to_contain_text("press Enter in the terminal of `greywhale dashboard`")
    expect(page.locator(".empty")).not_to_contain_text("Plug the board in")
    expect(page.get_by_role("button", name="Enable")).to_be_disabled()


def test_a_foreign_browser_gets_in_by_a_new_address_alone(context: BrowserContext, page: Page, stage: Stage) -> None:
    plain, used, new = f"http://127.0.0.1:{stage.port}/", stage.page_address, stage.page_address
    with browser_of(context).new_context() as other, stages.visit(other, stage):
        second = other.new_page()
        second.goto(used)
        expect(second.get_by_role("button", name="Take control")).to_be_visible()
        assert second.url == plain
    with browser_of(context).new_context() as other:
        stranger = other.new_page()
        stranger.add_init_script("requestAnimationFrame = () => 0")  # so nothing waits for the first picture
        for address, sentence in ((plain, "This address opens no page"), (used, "This address was used before")):
            require_refused(stranger, address, sentence)
            assert stranger.url == plain
        stranger.goto(new)
        expect(stranger.get_by_role("button", name="Take control")).to_be_visible()


def test_a_second_tab_of_the_same_browser_needs_no_ticket(context: BrowserContext, page: Page, stage: Stage) -> None:
    for address in (f"http://127.0.0.1:{stage.port}/", f"http://127.0.0.1:{stage.port}/#ticket=void"):
        second = context.new_page()
        second.goto(address)
        expect(second.get_by_role("button", name="Take control")).to_be_visible()
        second.close()


def test_the_page_of_a_server_that_was_started_anew_takes_the_token_of_a_new_page(
    context: BrowserContext, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    before = Stage(tmp_path)
    first = context.new_page()  # whose requests nobody answers meanwhile
    first.add_init_script("requestAnimationFrame = () => 0")
    with before.open():
        first.goto(before.page_address)
        expect(first.get_by_role("button", name="Let go")).to_be_visible()
    monkeypatch.setattr(server, "listen", partial(server.listen, before.port))
    stage = Stage(tmp_path)
    with stage.open():
        expect(first.get_by_role("alert")).to_contain_text("The token is missing or not this server's")
        with stages.visit(context, stage) as second:
            expect(second.page.get_by_role("button", name="Let go")).to_be_visible()
            first.wait_for_function(f"window.name.endsWith('{stage.access.token}')")
            expect(first.locator(".place")).not_to_be_empty()
        first.close()


def test_no_file_of_the_browser_keeps_the_token(
    context: BrowserContext, page: Page, stage: Stage, tmp_path: Path
) -> None:
    start = browser_of(context).browser_type.launch_persistent_context
    with start(tmp_path, executable_path=CHROMIUM, args=FLAGS) as own, stages.visit(own, stage) as visit:
        for _ in range(2):
            expect(visit.page.get_by_role("button", name="Take control")).to_be_visible()
            visit.page.reload()
        visit.page.goto("about:blank")
    files = {path: path.read_bytes() for path in tmp_path.rglob("*") if path.is_file()}
    keeping = {
        text: [path for path, data in files.items() if text.encode() in data or text.encode("utf-16-le") in data]
        for text in (stage.access.token, f"127.0.0.1:{stage.port}")
    }
    assert keeping[stage.access.token] == []
    assert keeping[f"127.0.0.1:{stage.port}"], "it keeps addresses"
