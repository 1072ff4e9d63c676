"""The page with a bench inside, in a browser that lacks WebAssembly or forbids it."""

from __future__ import annotations

from collections.abc import Callable

import pytest
from playwright.sync_api import BrowserContext, Route, expect

from tests.page import stage as stages
from tests.page.site.serve_folder import Site

pytestmark = pytest.mark.slow


def _none(route: Route) -> None:
    route.fulfill(body=f"delete globalThis.WebAssembly; {route.fetch().text()}", content_type="text/javascript")


def _forbidden(route: Route) -> None:
    """A worker's policy stands in the answer that brings it."""
    answer = route.fetch()
    route.fulfill(response=answer, headers={**answer.headers, "Content-Security-Policy": "script-src 'self'"})


@pytest.mark.parametrize("answer", [_none, _forbidden])
def test_the_page_says_what_is_missing_and_a_board_at_a_port_can_still_be_chosen(
    context: BrowserContext, site: Site, answer: Callable[[Route], None]
) -> None:
    context.route("**/worker.js", answer)
    with stages.visit(context, site) as visit:
        told = visit.page.locator("details.way-step[open]")
        expect(told).to_contain_text("does not run WebAssembly, of which the simulated bench is made")
        expect(told).to_contain_text("A board at a port needs none")
        visit.page.get_by_label("Board", exact=True).select_option("port")
        visit.page.get_by_role("button", name="Choose the port").click()
        expect(visit.page.get_by_role("heading", name="Board at a port")).to_be_visible()
    context.unroute("**/worker.js", answer)
