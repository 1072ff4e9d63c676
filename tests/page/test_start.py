"""The first view: the moving arm, and the way to one's own arm, whose cards say how far board and folder are."""

from __future__ import annotations

from collections.abc import Iterator
from pathlib import Path

import pytest
from playwright.sync_api import BrowserContext, Locator, Page, expect

from greywhale.files.log.layout import TITLE
from tests.page import stage as stages
from tests.page.barriers import DARK_AND_NARROW, LIGHT_AND_WIDE, require_no_barrier
from tests.page.stage import Stage, await_state

pytestmark = pytest.mark.slow

STEPS = ["Connect", "Flash", "Supply and driver", "Doctor", "Calibrate", "First enable", "Let it learn", "Work"]


class FirstStage(Stage):
    view = ""


def test_a_simulated_arm_follows_at_once_unless_somebody_had_stopped_it(
    context: BrowserContext, tmp_path: Path
) -> None:
    stage = Stage(tmp_path)
    stage.answers.follows = True
    with stage.open(), stages.visit(context, stage) as visit:
        await_state(visit.page, "following")
        press(visit.page, "Stop")
        await_state(visit.page, "disabled")
        visit.page.reload()
        visit.page.locator("button.enable:enabled").wait_for()
        stage.live(0.5)
        await_state(visit.page, "disabled")


@pytest.fixture
def visitor(context: BrowserContext, tmp_path: Path) -> Iterator[tuple[Page, Stage]]:
    """Somebody who opens the page of a new board for the first time."""
    stage = FirstStage(tmp_path)
    with stage.open(), stages.visit(context, stage) as visit:
        yield visit.page, stage


def step(page: Page, title: str) -> Locator:
    heading = page.get_by_role("heading", name=f"{STEPS.index(title) + 1} {title}", exact=True)
    return page.locator("details.way-step").filter(has=heading)


def require_marks(page: Page, *done: str) -> None:
    """These steps are done, and no other."""
    for title in STEPS:
        expect(step(page, title).locator(".way-mark")).to_have_text("done" if title in done else "not yet")


def test_the_way_to_ones_own_arm_says_how_far_a_board_is(visitor: tuple[Page, Stage]) -> None:
    page, _ = visitor
    expect(page.locator("nav button[aria-current]")).to_have_text("Start")
    page.locator("canvas[data-tick]").wait_for()
    require_marks(page, "Connect", "Flash")
    expect(step(page, "Supply and driver")).to_have_attribute("open", "")
    press(page, "Next: Set them")
    press(page, "Store")
    expect(page.get_by_text("What runs is stored.")).to_be_visible()
    press(page, "Start")
    require_marks(page, "Connect", "Flash", "Supply and driver")
    press(page, "Next: Let it look")
    press(page, "Start doctor", "Start")
    expect(step(page, "Doctor")).to_contain_text("It has found something to mend.")
    expect(step(page, "Doctor")).to_contain_text("Mend 1 finding before the arm moves")  # a stage's port is none
    require_marks(page, "Connect", "Flash", "Supply and driver")
    step(page, "First enable").locator("summary").click()
    step(page, "First enable").get_by_role("button", name="Enable").click()
    await_state(page, "following")
    require_marks(page, "Connect", "Flash", "Supply and driver", "First enable", "Work")
    page.keyboard.press("Space")
    await_state(page, "disabled")
    require_no_barrier(page, LIGHT_AND_WIDE, DARK_AND_NARROW, views="Start")


def test_learning_goes_on_where_the_folder_is_and_a_reload_stays_in_its_view(visitor: tuple[Page, Stage]) -> None:
    page, stage = visitor
    (stage.folder / "fit.csv").write_text(f"# {TITLE}\n", encoding="utf-8")
    press(page, "Live", "Start")  # whose folder is read anew
    learn = step(page, "Let it learn")
    learn.locator("summary").click()
    expect(learn.locator(".told")).to_contain_text("Here are: 1 recording.")
    press(page, "Step by step: identify")
    expect(page.locator(".verb-form [name=logs][value='fit.csv']")).to_be_checked()
    page.reload()
    expect(page.locator("nav button[aria-current]")).to_have_text("Do")


def press(page: Page, *names: str) -> None:
    for name in names:
        page.get_by_role("button", name=name, exact=True).click()
