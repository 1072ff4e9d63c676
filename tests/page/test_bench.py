"""The bench's view: what a person does with it happens to the simulated arm."""

from __future__ import annotations

import pytest
from playwright.sync_api import BrowserContext, Page, expect

from greywhale.protocol.schema import Sample, State
from tests.page import stage as stages
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
    page.locator(".pad").first.scroll_into_view_if_needed()
    pad = page.locator(".pad").first.bounding_box()
    assert pad is not None
    page.mouse.move(pad["x"] + pad["width"] / 2, pad["y"] + pad["height"] / 2)
    page.mouse.down()
    page.mouse.move(pad["x"] + 0.45 * pad["width"], pad["y"] + 0.45 * pad["height"])
    page.mouse.up()
    stage.wait_for(lambda: stage.newest().leader[0] < 0 < stage.newest().leader[1])


def test_another_motion_takes_one_click_while_the_arm_follows(page: Page, stage: Stage) -> None:
    page.get_by_role("button", name="Enable").click()
    await_state(page, "following")
    page.get_by_role("button", name="Bench").click()
    page.get_by_label("Leader, wrist roll, rad").fill("-1")
    wanted = -1.0 / Sample.LSB["leader"]
    stage.wait_for(lambda: abs(stage.newest().leader[3] - wanted) < 100)
    begun = stage.newest().tick
    page.get_by_role("button", name="Take the paper's steps").click()
    stage.wait_for(lambda: stage.newest().leader[3] > 0.9 / Sample.LSB["leader"])  # the first step
    assert {State(sample.state) for sample in stage.samples() if sample.tick >= begun} == {State.FOLLOWING}
    expect(page.locator(".notice")).to_be_hidden()


def test_what_is_broken_on_the_page_is_broken_on_the_bench(page: Page, stage: Stage) -> None:
    page.get_by_role("button", name="Bench").click()
    page.get_by_label("Fault").select_option("Wiper's wire touches 5 V")
    page.get_by_label("Where").select_option("leader potentiometer 2, wrist pitch")
    page.get_by_role("button", name="Break", exact=True).click()
    broken = "Wiper's wire touches 5 V: leader potentiometer 2, wrist pitch"
    expect(page.locator(".differences li")).to_have_text(broken)
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
    page.get_by_text("Draw a motion").click()
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


def test_a_page_that_only_watches_leaves_the_bench_alone_and_says_why(
    context: BrowserContext, page: Page, stage: Stage
) -> None:
    before = stage.command("controls")
    with stages.visit(context, stage) as watcher:
        why = "Another page drives this arm; let go there first."
        watcher.page.get_by_role("button", name="Bench").click()
        for name in ("Break", "Mend all", "Hold still", "Cut the power", "Press the emergency stop"):
            expect(watcher.page.get_by_role("button", name=name, exact=True)).to_be_disabled()
        expect(watcher.page.get_by_label("Supply, V")).to_be_disabled()
        expect(watcher.page.locator(".in-the-way .reason")).to_have_text(why)
        watcher.page.locator("button.enable").hover(force=True)
        expect(watcher.page.locator("button.enable")).to_have_attribute("title", why)
        page.get_by_role("button", name="Let go").click()
        expect(watcher.page.get_by_role("button", name="Break", exact=True)).to_be_enabled()
        expect(watcher.page.locator("fieldset")).to_have_attribute("title", "")
        page.get_by_role("button", name="Take control").click()
        expect(watcher.page.get_by_role("button", name="Break", exact=True)).to_be_disabled()
    assert stage.command("controls") == before


def test_a_fault_its_remedy_and_its_end_stand_in_every_view(page: Page, stage: Stage) -> None:
    page.get_by_role("button", name="Enable").click()
    await_state(page, "following")
    stage.command("pot follower 1 open")
    await_state(page, "fault")
    stage.command("pot follower 1 connected")
    enable = page.locator("button.enable")
    for view in page.locator("nav button").all():
        view.click()
        fault = page.get_by_role("alert").filter(has_text="follower potentiometer 1")
        expect(fault).to_contain_text("wiper")
        expect(fault.get_by_role("button", name="Clear fault")).to_be_enabled()
        expect(enable).to_have_attribute("title", "A fault keeps the motors off; do what it says, and clear it.")
    page.get_by_role("button", name="Bench", exact=True).click()
    expect(page.locator(".mark")).to_have_text("Follower potentiometer 1, shoulder pitch")
    stage.live(1.0)
    page.get_by_role("button", name="Clear fault").click()
    expect(enable).to_be_enabled()
    expect(enable).to_have_attribute("title", "Starts the motors through the soft start")
    expect(page.get_by_role("button", name="Clear fault")).to_be_hidden()
