"""Parameters of a board behind the server: changed, stored, and left alone by a page that only watches."""

from __future__ import annotations

import pytest
from playwright.sync_api import BrowserContext, Page, expect

from greywhale.protocol.schema import PARAMETER_BY_NAME, PARAMETERS
from tests.page import stage as stages
from tests.page.barriers import DARK_AND_NARROW, require_no_barrier
from tests.page.stage import Stage

pytestmark = pytest.mark.slow

TRACKING = PARAMETER_BY_NAME["tracking_ms"]


YAW = sum(parameter.name.startswith("joint0.") for parameter in PARAMETERS)


def press(page: Page, *names: str) -> None:
    for name in names:
        page.get_by_role("button", name=name, exact=True).click()


def test_a_parameter_is_changed_and_stored_and_what_is_stored_is_told(
    context: BrowserContext, page: Page, stage: Stage
) -> None:
    press(page, "Parameters")
    expect(page.get_by_text("Nothing is stored: the board starts with what runs, its defaults.")).to_be_visible()
    expect(page.get_by_role("button", name="Apply", exact=True)).to_have_attribute("title", "Nothing is changed here.")
    page.get_by_label(TRACKING.name).fill("300")
    page.get_by_label(TRACKING.name).press("Tab")
    press(page, "Apply")
    expect(page.get_by_text("One parameter is not stored: the board starts with its defaults.")).to_be_visible()
    assert stage.runs(TRACKING) == {TRACKING.name: 300}
    press(page, "Store")
    expect(page.get_by_text("The board has stored what runs.")).to_be_visible()
    with stages.visit(context, stage) as watcher:
        press(watcher.page, "Parameters")
        expect(watcher.page.get_by_label(TRACKING.name)).to_have_value("300")
        expect(watcher.page.get_by_text("The board has stored what runs.")).to_be_visible()
        for name in ("Apply", "Store"):
            found = watcher.page.get_by_role("button", name=name, exact=True)
            expect(found).to_be_disabled()
            expect(found).to_have_attribute("title", "Another page drives this arm; let go there first.")
        expect(watcher.page.get_by_role("button", name="Save to a file")).to_be_enabled()
    require_no_barrier(page, DARK_AND_NARROW, views="Parameters")

    page.get_by_label("joint0.limit_max").fill("1")
    page.get_by_label("joint0.limit_max").press("Tab")
    press(page, "Apply", "Store")
    # It says so when the calibration is kept, too; that the board has stored it, it says before.
    expect(page.get_by_text("What runs is stored.")).to_be_visible()
    press(page, "Calibrate")
    expect(page.get_by_text("Earlier calibrations (2)")).to_be_visible()


def test_rows_are_found_by_name_meaning_and_joint_and_counted(page: Page) -> None:
    press(page, "Parameters")
    rows, counted = page.locator(".scroll tbody tr:visible"), page.get_by_text("parameters", exact=False)
    page.locator("body").press("/")
    search = page.get_by_role("searchbox", name="Search parameters")
    expect(search).to_be_focused()
    search.press_sequentially("base YAW")
    expect(counted.get_by_text(f"{YAW} of {len(PARAMETERS)} parameters")).to_be_visible()
    expect(rows).to_have_count(YAW)
    search.fill("fault nearer")
    expect(rows).to_have_count(1)
    expect(page.get_by_label(TRACKING.name)).to_be_visible()
    require_no_barrier(page, DARK_AND_NARROW, views="Parameters")
    search.fill("")
    expect(rows).to_have_count(len(PARAMETERS))
