"""One browser for all tests of the page, and a stage and a page for those of each file."""

from __future__ import annotations

import contextlib
from collections.abc import Iterator

import pytest
from playwright.sync_api import BrowserContext, Page

from greywhale.base import state
from tests.page import stage as stages
from tests.page.stage import Stage, await_state


@pytest.fixture(scope="session")
def context() -> Iterator[BrowserContext]:
    with stages.browser() as browser, stages.profile(browser) as shared:
        yield shared


@pytest.fixture(scope="module", autouse=True)
def _calibrations_of_their_own(tmp_path_factory: pytest.TempPathFactory) -> Iterator[None]:
    """Every bench is the same board; the tests of another file have calibrated it, too."""
    with pytest.MonkeyPatch.context() as patch:
        patch.setenv(state.VARIABLE, str(tmp_path_factory.mktemp("state")))
        yield


@contextlib.contextmanager
def at_rest(context: BrowserContext, stage: Stage) -> Iterator[Page]:
    """A page that drives."""
    with stages.visit(context, stage) as visit:
        visit.page.locator("button.enable:enabled").wait_for()
        yield visit.page


@pytest.fixture(scope="module")
def stage(tmp_path_factory: pytest.TempPathFactory) -> Iterator[Stage]:
    """The server around a bench, for all tests of a file: for those that do not mind what others did."""
    made = Stage(tmp_path_factory.mktemp("folder"))
    with made.open():
        yield made


@pytest.fixture(scope="module")
def shared_page(context: BrowserContext, stage: Stage) -> Iterator[Page]:
    with at_rest(context, stage) as opened:
        yield opened


@pytest.fixture
def page(shared_page: Page) -> Iterator[Page]:
    """It drives a board whose motors other tests have left off."""
    yield shared_page
    shared_page.get_by_role("button", name="Stop", exact=True).click()
    await_state(shared_page, "disabled")
