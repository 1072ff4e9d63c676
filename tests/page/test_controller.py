"""The controller view: a set dragged in the browser runs on the board as the page says, and comes back as it was."""

from __future__ import annotations

import re
from pathlib import Path

import pytest
from playwright.sync_api import BrowserContext, Page, expect

from greywhale.files.arm import content_of
from greywhale.protocol.schema import (
    DEFAULTS,
    PARAMETER_BY_NAME,
    ParamApplyReply,
    ParamApplyRequest,
    ParamSetReply,
    ParamSetRequest,
    param_crc,
)
from tests.dashboard.browser import BoardSocket
from tests.dashboard.browser import Page as Watcher
from tests.page.barriers import DARK_AND_NARROW, LIGHT_AND_WIDE, require_no_barrier
from tests.page.conftest import at_rest
from tests.page.drag import drag, value_of
from tests.page.stage import Stage, await_state

pytestmark = pytest.mark.slow

PE_B, KP = PARAMETER_BY_NAME["joint1.pe_b"], PARAMETER_BY_NAME["joint1.kp"]
KP0 = PARAMETER_BY_NAME["joint0.kp"]
ZE_A, ZE_C = PARAMETER_BY_NAME["joint0.ze_a"], PARAMETER_BY_NAME["joint0.ze_c"]


def test_a_dragged_set_runs_on_the_board(context: BrowserContext, tmp_path: Path) -> None:
    stage = Stage(tmp_path)
    with stage.open(), at_rest(context, stage) as page:
        page.get_by_role("button", name="Controller").click()
        expect(page.get_by_text("Nothing is stored: the board starts with these, its defaults.")).to_be_visible()
        page.get_by_role("button", name="Joint 1").click()
        predicted = page.locator(".predict[data-rms]")
        before = predicted.get_attribute("data-rms")
        drag(page, "Pe_b", 0.1)
        assert value_of(page, "Pe_b") == pytest.approx(0.5, abs=0.03)
        expect(page.locator(f".predict:not([data-rms='{before}'])")).to_be_visible()  # the answer to the new set
        page.get_by_label("Kp 1/rad").fill("0.75")
        page.get_by_label("Kp 1/rad").press("Enter")
        expect(page.get_by_role("region", name="Not yet on the board")).to_contain_text("0.59 → 0.75")
        expect(page.get_by_text("The same: nothing is stored")).to_be_visible()
        page.get_by_role("button", name="Apply").click()
        expect(page.get_by_text("The board runs these controllers.")).to_be_visible()
        board = stage.runs(PE_B, KP)
        assert PE_B.to_physical(board[PE_B.name]) == pytest.approx(value_of(page, "Pe_b"), abs=PE_B.lsb)
        assert KP.to_physical(board[KP.name]) == 0.75
        stored = page.locator(".differences").nth(1)
        expect(stored).to_contain_text("0.59 → 0.75")  # its default
        page.get_by_role("button", name="Store").click()
        expect(stored).to_have_text("The board has stored these controllers.")
        page.get_by_role("button", name="Live").click()
        expect(page.locator(".facts")).to_contain_text("written and read back")
        page.reload()
        page.get_by_role("button", name="Controller").click()
        expect(stored).to_have_text("The board has stored these controllers.")


def test_corners_keep_to_what_the_board_takes_and_steps_can_be_undone(page: Page) -> None:
    page.get_by_role("button", name="Controller").click()
    drag(page, "Pe_b", -0.9)
    assert value_of(page, "Pe_b") == pytest.approx(0.01, abs=1e-4)
    page.get_by_role("slider", name="Pe_b", exact=True).press("ArrowRight")
    assert value_of(page, "Pe_b") == pytest.approx(0.02, abs=1e-4)
    for step, wanted in (("Undo", 0.01), ("Undo", 0.3), ("Redo", 0.01), ("Undo", 0.3)):
        page.get_by_role("button", name=step).click()
        assert value_of(page, "Pe_b") == pytest.approx(wanted, abs=1e-4)
    expect(page.get_by_role("button", name="Apply")).to_be_disabled()
    place = page.locator("svg.sets").first.bounding_box()
    page.get_by_label("Kp 1/rad").fill("65")
    page.get_by_label("Kp 1/rad").press("Enter")
    expect(page.get_by_role("alert")).to_contain_text("Joint 0: Kp is 65; choose a value from 0 to 64 1/rad.")
    assert page.locator("svg.sets").first.bounding_box() == place, "a notice moves nothing under a hand that drags"


def test_two_controllers_are_compared_on_the_running_arm_by_one_key(page: Page, stage: Stage) -> None:
    stage.hold(20)  # a leader that rests is still near when the motors go on again
    page.get_by_role("button", name="Enable").click()
    await_state(page, "following")
    page.get_by_role("button", name="Controller").click()
    expect(page.get_by_text("A runs", exact=True)).to_be_visible()
    drag(page, "Ze_c", 0.1)
    expect(page.get_by_text("B runs, A is edited")).to_be_visible()
    page.get_by_role("button", name="Apply").click()
    expect(page.get_by_text("A runs", exact=True)).to_be_visible()
    expect(page.get_by_role("button", name="Run B")).to_be_enabled()
    await_state(page, "following")
    assert stage.runs(ZE_C)[ZE_C.name] > DEFAULTS[ZE_C.index]
    page.keyboard.press("x")
    expect(page.get_by_text("B runs", exact=True)).to_be_visible()
    expect(page.get_by_role("button", name="Run A")).to_be_enabled()
    expect(page.locator(".notice")).to_be_hidden()
    assert stage.runs() == {}
    await_state(page, "following")


def test_what_runs_and_what_is_edited_are_predicted_for_every_joint_and_arm(page: Page, stage: Stage) -> None:
    (stage.folder / "mine.toml").write_bytes(content_of("worn"))
    page.get_by_role("button", name="Controller").click()
    told = page.get_by_role("region", name="What the model predicts for each joint")
    expect(told.get_by_role("row")).to_have_count(5)
    expect(told).not_to_contain_text("→")
    drag(page, "Pe_b", 0.1)
    changed = told.get_by_role("row").filter(has_text="→")
    expect(changed.first).to_contain_text(re.compile(r"^0\d"))  # of the joint whose set was dragged
    expect(page.get_by_text("The arm default as it is described")).to_be_visible()
    page.get_by_role("button", name="Discard").click()
    expect(told).not_to_contain_text("→")
    row = told.get_by_role("row").nth(1)
    others = row.text_content() or ""
    page.get_by_label("Model", exact=True).select_option("mine.toml")
    expect(page.get_by_text("The arm mine.toml as it is described")).to_be_visible()
    expect(row).not_to_have_text(others)
    page.get_by_label("Model", exact=True).select_option("default")
    expect(row).to_have_text(others)


def test_what_another_host_changed_is_shown_and_what_it_left_half_done_does_not_run(page: Page, stage: Stage) -> None:
    page.get_by_role("button", name="Controller").click()
    expect(page.get_by_label("Kp 1/rad")).to_have_value(f"{KP0.to_physical(DEFAULTS[KP0.index]):g}")
    page.get_by_role("button", name="Let go").click()
    expect(page.get_by_role("button", name="Take control")).to_be_enabled()  # so the server knows that nobody drives
    with Watcher(stage.port, stage.access.token).open("/board") as socket:
        other = BoardSocket(socket)
        socket.say({"kind": "drive"})
        other.word("driver", you=True)
        values = list(DEFAULTS)
        values[KP0.index] = KP0.to_raw(0.5)
        other.frame(ParamSetReply.TYPE, other.ask(ParamSetRequest(KP0.index, values[KP0.index])))
        other.frame(ParamApplyReply.TYPE, other.ask(ParamApplyRequest(param_crc(values))))
        other.frame(ParamSetReply.TYPE, other.ask(ParamSetRequest(KP.index, 2 * DEFAULTS[KP.index])))
    expect(page.get_by_label("Kp 1/rad")).to_have_value("0.5")
    expect(page.get_by_text("The board runs these controllers.")).to_be_visible()
    page.get_by_role("button", name="Take control").click()
    expect(page.get_by_role("button", name="Let go")).to_be_visible()  # the picture has its place
    drag(page, "Ze_a", -0.1)
    page.get_by_role("button", name="Apply").click()
    expect(page.get_by_text("The board runs these controllers.")).to_be_visible()
    assert stage.runs(ZE_A, KP0)[ZE_A.name] < DEFAULTS[ZE_A.index]


def test_the_host_tunes_and_its_best_so_far_can_be_applied(page: Page, stage: Stage) -> None:
    page.get_by_role("button", name="Controller").click()
    page.get_by_role("button", name="Tune", exact=True).click()
    expect(page.get_by_text(re.compile(r"%; the best cost together \d"))).to_be_visible()
    page.get_by_role("button", name="Stop the search").click()
    expect(page.get_by_text("The best controllers so far are in controller.toml")).to_be_visible()
    expect(page.get_by_role("region", name="What the tuning changed").get_by_role("row")).to_have_count(5)
    assert "unfinished" in (stage.folder / "controller.toml").read_text("utf-8")
    require_no_barrier(page, LIGHT_AND_WIDE, DARK_AND_NARROW, views="Controller")
