"""The live view and the frame around it: every sample, stop in each way, nothing left to chance or to strangers."""

from __future__ import annotations

import shutil
from collections.abc import Callable
from pathlib import Path

import numpy as np
import pytest
from playwright.sync_api import BrowserContext, Page, expect

from greywhale.files.log import read_log
from greywhale.files.log.check import Check
from greywhale.protocol.schema import Sample, State
from tests.page import stage as stages
from tests.page.stage import Stage, await_state
from tools import ROOT

pytestmark = pytest.mark.slow

LEAST_LOG = 1500  # samples
ROUNDED = 0.51e-3  # what is shown with three digits may be off by so much
OFF_TICKS = 300
MODEL = ROOT / "tests/observe/default_model.toml"
PUSH_NM = 0.7  # that the motor holds against
# A browser's sound, of which the pitches are kept.
STUB = """() => {
  window.tones = [];
  window.AudioContext = class {
    state = "running"; currentTime = 0; destination = {};
    createGain() {
      return { gain: { setValueAtTime() {}, linearRampToValueAtTime() {} }, connect: (next) => next };
    }
    createOscillator() {
      const frequency = {};
      return { frequency, connect: (next) => next, start: () => tones.push(frequency.value), stop() {} };
    }
  };
}"""


def start(page: Page, stage: Stage) -> None:
    stage.hold(20)  # a leader that rests is near wherever the motors were left off
    enable(page)


def enable(page: Page) -> None:
    page.get_by_role("button", name="Enable").click()
    await_state(page, "following")


def test_the_page_saves_and_shows_the_boards_samples_as_they_are(page: Page, stage: Stage) -> None:
    enable(page)
    begun = stage.newest().tick
    stage.wait_for(lambda: stage.newest().tick > begun + LEAST_LOG)
    page.get_by_role("button", name="Pause").click()
    page.get_by_role("button", name="Save view").click()
    expect(page.get_by_text(f"is in {stage.folder}, and in the view Files.")).to_be_visible()
    (saved,) = stage.folder.glob("view-*.csv")
    log = read_log(saved)
    assert log.condition.check is Check.WHOLE
    sent = {sample.tick: sample for sample in stage.samples()}
    ticks = np.round(log.time * 1000).astype(int)
    assert len(ticks) > LEAST_LOG
    assert set(np.diff(ticks)) == {1}, "no tick is missing"
    for name, column in (("leader", log.leader), ("follower", log.follower), ("voltage", log.voltage)):
        counts = np.round(column / Sample.LSB[name]).astype(int)
        assert counts.tolist() == [list(getattr(sent[tick], name)) for tick in ticks], name
    assert log.origin.table is not None  # so the whole parameter set stands in the header
    page.get_by_label("Span shown").select_option("1")
    page.get_by_role("button", name="Zoom in").click()
    expect(page.get_by_text("every sample")).to_be_visible()
    plot = page.locator(".u-over").first.bounding_box()
    assert plot is not None
    page.mouse.move(plot["x"] + 0.6 * plot["width"], plot["y"] + 20)
    expect(page.locator(".values thead th").first).to_contain_text("at ")
    tick = int(page.locator(".live").get_attribute("data-tick") or "")
    shown = [row.split() for row in page.locator(".values tbody tr").all_inner_texts()]
    sample = sent[tick]
    for joint in range(4):
        leader, follower = (values[joint] * Sample.LSB["leader"] for values in (sample.leader, sample.follower))
        *angles, volts = map(float, shown[joint][-4:])
        assert angles == pytest.approx([leader, follower, leader - follower], abs=ROUNDED / 10)
        assert volts == pytest.approx(sample.voltage[joint] * Sample.LSB["voltage"], abs=ROUNDED)
    page.get_by_role("button", name="Go on").click()


def require_off(stage: Stage, pressed: int) -> None:
    """The motors were off soon after that tick."""
    stage.wait_for(lambda: stage.newest().state is State.DISABLED)
    running = [sample.tick for sample in stage.samples() if sample.state is State.FOLLOWING]
    assert running[-1] - pressed <= OFF_TICKS
    stage.still = False


def test_the_motors_go_off_by_the_button_and_by_the_space_bar_wherever_the_focus_is(page: Page, stage: Stage) -> None:
    ways: list[Callable[[], None]] = [
        page.get_by_role("button", name="Stop").click,
        lambda: page.keyboard.press("Space"),
    ]
    for stop in ways:
        start(page, stage)
        page.locator("select").first.focus()
        pressed = stage.stand_still()
        stop()
        require_off(stage, pressed)


def test_a_second_page_watches_a_reload_loses_nothing_and_a_page_that_is_gone_stops_the_motors(
    context: BrowserContext, page: Page, stage: Stage
) -> None:
    start(page, stage)
    with stages.visit(context, stage) as second:
        await_state(second.page, "following")
        expect(second.page.get_by_role("button", name="Enable")).to_be_disabled()
        expect(second.page.get_by_role("button", name="Take control")).to_be_disabled()
        page.get_by_role("button", name="Let go").click()
        await_state(second.page, "disabled")
        second.page.get_by_role("button", name="Take control").click()
        expect(second.page.get_by_role("button", name="Enable")).to_be_enabled()
        second.page.get_by_role("button", name="Let go").click()
        expect(page.get_by_role("button", name="Take control")).to_be_enabled()  # so the page that loads anew drives
        second.page.reload()
        expect(second.page.locator(".values thead th").first).to_have_text("now")
        kept = second.page.locator(".live").evaluate("({ dataset }) => ({ ...dataset })")
        sent = [sample.tick for sample in stage.samples() if sample.tick <= int(kept["tick"])]
        assert kept == {"first": str(sent[0]), "tick": str(sent[-1]), "count": str(len(sent))}
        start(second.page, stage)
        expect(page.get_by_role("button", name="Take control")).to_be_disabled()
        pressed = stage.stand_still()
    expect(page.get_by_role("button", name="Take control")).to_be_enabled()  # so the server knows that it is gone
    stage.live(1.0)
    require_off(stage, pressed)
    page.get_by_role("button", name="Take control").click()


def test_a_fault_is_captured_and_told_with_its_remedy_until_it_is_cleared(page: Page, stage: Stage) -> None:
    start(page, stage)
    page.get_by_label("Span shown").select_option("1")
    page.get_by_label("Event").select_option("fault")
    page.get_by_role("button", name="Wait for it").click()
    stage.command("pot follower 1 open")
    fault = page.get_by_role("alert").filter(has_text="follower potentiometer 1")
    expect(fault).to_contain_text("wiper")
    stage.command("pot follower 1 connected")
    stage.live(1.0)
    expect(page.get_by_role("button", name="Go on")).to_be_visible()
    tick = next(sample.tick for sample in stage.samples() if sample.state is State.FAULT)
    expect(page.get_by_text(f"It happened at {tick / 1000:.3f} s.")).to_be_visible()
    fault.get_by_role("button", name="Clear fault").click()
    await_state(page, "disabled")


def test_the_clutch_is_disengaged_by_a_click_and_by_the_pedal(page: Page, stage: Stage) -> None:
    start(page, stage)
    card = page.locator(".card").filter(has_text="Clutch")
    card.get_by_role("button", name="Disengage").click()
    expect(card).to_contain_text("The reference rests")
    card.get_by_role("button", name="Engage").click()
    expect(card).to_contain_text("Engaged in another place")
    expect(card.get_by_role("button", name="Reset")).to_be_disabled()
    page.get_by_role("button", name="Stop").click()
    card.get_by_role("button", name="Reset").click()
    expect(card).to_contain_text("the leader's angle times the ratio")
    stage.command("clutch press")
    stage.live(0.1)
    expect(card).to_contain_text("The reference rests")


def test_a_push_is_shown_told_and_sounded_by_a_model_of_the_folder(page: Page, stage: Stage) -> None:
    card = page.locator(".torque")
    expect(page.get_by_role("heading", name="Episodes")).to_be_visible()
    expect(card).to_be_hidden()  # there is no model
    shutil.copy(MODEL, stage.folder / "model.toml")
    page.get_by_role("button", name="Parameters").click()
    page.get_by_role("button", name="Live").click()
    page.evaluate(STUB)
    sound = card.get_by_role("button", name="Sound")
    expect(sound).to_have_attribute("aria-pressed", "false")
    sound.click()
    start(page, stage)
    expect(card.locator("td").first).not_to_have_text("–")  # the server has begun to listen
    stage.command(f"push 0 {PUSH_NM}")
    expect(card.locator('tr[data-contact="yes"]')).to_contain_text("contact +")
    expect(card.locator("[aria-live]")).to_contain_text("Contact: joint 0 at")
    page.wait_for_function("() => tones.length > 0", polling=50)
    assert page.evaluate("tones[0]") == 330
    stage.command("push 0 0")
    expect(card.locator("[aria-live]")).to_contain_text("Last contact: joint 0 at")
    page.get_by_role("button", name="Stop").click()
    expect(card.locator("td").first).to_have_text("motors off")
    sound.click()
    expect(sound).to_have_attribute("aria-pressed", "false")


def test_without_a_board_the_page_says_what_to_do_and_takes_one_that_comes(
    context: BrowserContext, tmp_path: Path
) -> None:
    stage = Stage(tmp_path)
    stage.plugged.clear()
    with stage.open(), stages.visit(context, stage) as visit:
        expect(visit.page.get_by_text("Plug the board in by USB")).to_be_visible()
        visit.page.get_by_role("button", name="Files").click()
        expect(visit.page.get_by_text("Plug the board in by USB")).to_be_hidden()
        visit.page.get_by_role("button", name="Live").click()
        expect(visit.page.get_by_text("Plug the board in by USB")).to_be_visible()
        stage.plugged.set()
        visit.page.locator("button.enable:enabled").wait_for()
        expect(visit.page.get_by_text("Plug the board in by USB")).to_be_hidden()
