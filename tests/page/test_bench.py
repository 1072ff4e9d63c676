"""The bench's view: what a person does with it happens to the simulated arm."""

from __future__ import annotations

import pytest
from playwright.sync_api import Page, expect

from greywhale.protocol.schema import Sample
from tests.page.stage import Stage, await_state

pytestmark = pytest.mark.slow


def test_a_hand_on_the_page_leads_and_the_arm_follows(page: Page, stage: Stage) -> None:
    page.get_by_role("button", name="Enable").click()
    await_state(page, "following")
    page.get_by_role("button", name="Bench").click()
    page.get_by_label("Leader, base yaw, rad").fill("0.5")
    wanted = 0.5 / Sample.LSB["leader"]
    stage.wait_for(lambda: abs(stage.newest().leader[0] - wanted) < 100)
    stage.wait_for(lambda: abs(stage.newest().follower[0] - wanted) < 500)
    pad = page.locator(".pad").first.bounding_box()
    assert pad is not None
    page.mouse.move(pad["x"] + pad["width"] / 2, pad["y"] + pad["height"] / 2)
    page.mouse.down()
    page.mouse.move(pad["x"] + 0.45 * pad["width"], pad["y"] + 0.45 * pad["height"])
    page.mouse.up()
    stage.wait_for(lambda: stage.newest().leader[0] < 0 < stage.newest().leader[1])


def test_what_is_broken_on_the_page_is_broken_on_the_bench(page: Page, stage: Stage) -> None:
    page.get_by_role("button", name="Bench").click()
    page.get_by_label("Fault").select_option("pot-shorted")
    page.get_by_label("Where").select_option("leader2")
    page.get_by_role("button", name="Break", exact=True).click()
    expect(page.locator(".differences li")).to_have_text("pot-shorted:leader2")
    page.get_by_role("button", name="Enable").click()
    expect(page.get_by_role("alert").first).to_contain_text("leader potentiometer 2")
    page.get_by_role("button", name="Mend all").click()
    expect(page.locator(".differences li")).to_have_count(0)
    stage.live(0.1)  # until the board sees it as well, and enables again
    page.get_by_label("Supply, V").fill("9")
    page.get_by_label("Supply, V").dispatch_event("change")
    page.get_by_role("button", name="Enable").click()
    await_state(page, "following")
    assert stage.command("controls")["supply"]["value"] == pytest.approx(9.0, abs=0.3)


def test_a_drawn_motion_leads_the_arm(page: Page, stage: Stage) -> None:
    page.get_by_role("button", name="Bench").click()
    expect(page.get_by_role("button", name="Play")).to_be_disabled()
    page.get_by_label("Joint to draw").select_option("2")
    page.get_by_label("Duration").select_option("2")
    picture = page.get_by_role("img", name="Drawn motion")
    picture.scroll_into_view_if_needed()
    drawn = picture.bounding_box()
    assert drawn is not None
    page.mouse.move(drawn["x"], drawn["y"] + 0.5 * drawn["height"])
    page.mouse.down()
    page.mouse.move(drawn["x"] + 0.99 * drawn["width"], drawn["y"] + 0.2 * drawn["height"])
    page.mouse.up()
    page.get_by_role("button", name="Play").click()
    leader = stage.command("controls")["leader"]
    low, high = leader["minimum"][2], leader["maximum"][2]
    end = (high - 0.2 * (high - low)) / Sample.LSB["leader"]
    stage.wait_for(lambda: abs(stage.newest().leader[2] - end) < 100)
    expect(page.get_by_role("button", name="Play", exact=True)).to_be_visible()
