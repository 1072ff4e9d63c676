"""The folder's files on the page: brought, renamed, deleted, used; logs over each other with a terminal's measures."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest
from playwright.sync_api import BrowserContext, Page, expect

from greywhale.files.log import LogWriter, read_log
from greywhale.files.log.check import Check
from greywhale.files.log.layout import Origin
from greywhale.measure import evaluate
from tests.page import stage as stages
from tests.page.stage import Stage, await_state

pytestmark = pytest.mark.slow

LAG_TICKS = {"close.csv": 40, "late.csv": 90}
JOINT = 1


def write(path: Path, lag: int) -> None:
    """Two moves between rests, followed after so many ticks and never quite."""
    t = np.arange(6000) / 1000
    leader = np.clip(t - 1.0, 0.0, 0.8) - np.clip(t - 3.5, 0.0, 0.8)
    follower = 0.95 * np.concatenate([np.zeros(lag), leader[:-lag]])
    with LogWriter(path, Origin()) as log:
        for time_s, led, followed in zip(t, leader, follower, strict=True):
            log.append(time_s, 4 * [led], 4 * [followed], 4 * [led - followed], "following")


def test_two_logs_lie_over_each_other_and_what_is_none_is_told_as_in_a_terminal(
    context: BrowserContext, stage: Stage
) -> None:
    with stages.visit(context, stage) as visit:
        require_two_logs_with_the_measures_of_evaluate(visit.page, stage.folder)
        (stage.folder / "bad.csv").write_text(
            (stage.folder / "late.csv").read_text().replace(",following\n", ",<b>x</b>\n", 1)
        )
        visit.page.reload()
        require_an_error_beside_a_log(visit.page)
        (said,) = visit.strange  # by the browser, of each answer that refuses
        assert "status of 400" in said
        visit.strange.clear()


def require_two_logs_with_the_measures_of_evaluate(page: Page, folder: Path) -> None:
    for name, lag in LAG_TICKS.items():
        write(folder / name, lag)
    page.get_by_role("button", name="Files", exact=True).click()
    for name in LAG_TICKS:
        page.get_by_role("button", name=name).click()
    page.get_by_label("Joint shown").select_option(str(JOINT))
    logs = {name: read_log(folder / name) for name in LAG_TICKS}
    measured = page.get_by_role("region", name="Measures").locator("tbody tr")
    for row, (name, log) in enumerate(logs.items()):
        found = evaluate(log).as_dict()["joints"][JOINT]
        sizes = found["mse_rad2"], found["steady_state_error_rad"], found["settling_error_rad"], found["time_delay_s"]
        texts = [f"{size:.{digits}f}" for size, digits in zip(sizes, (6, 4, 4, 4), strict=True) if size is not None]
        assert len(texts) == len(sizes)
        expect(measured.nth(row).locator("th, td")).to_have_text([name, *texts])
    plot = page.locator(".logs .u-over").first.bounding_box()
    assert plot is not None
    page.mouse.move(plot["x"] + 0.25 * plot["width"], plot["y"] + 20)
    moment = page.locator(".logs thead th").first
    expect(moment).to_contain_text("at 1.")
    tick = int(np.ceil(1000 * float(moment.inner_text().split()[1])))
    shown = page.locator(".logs .values").first.locator("tbody tr")
    for row, log in enumerate(logs.values()):
        told = [float(text) for text in shown.nth(row).locator("td").all_inner_texts()]
        led, followed = log.leader[tick, JOINT], log.follower[tick, JOINT]
        assert told[:3] == pytest.approx([led, followed, led - followed], abs=1.1e-3)
    page.get_by_role("button", name="Do", exact=True).click()
    expect(page.locator(".job")).to_have_count(0)  # the measures stand in the view Files


def test_a_file_is_brought_used_renamed_and_deleted(shared_page: Page, stage: Stage) -> None:
    page, folder = shared_page, stage.folder
    write(folder / "kept.csv", 40)
    content = (folder / "kept.csv").read_bytes()
    page.get_by_role("button", name="Files", exact=True).click()
    expect(page.get_by_text(str(folder))).to_be_visible()
    bring = page.get_by_label("Bring files here, or drop them on this list")
    bring.set_input_files(folder / "kept.csv")
    page.get_by_role("button", name="Keep both").click()
    page.get_by_role("button", name="kept-2.csv").click()
    assert (folder / "kept-2.csv").read_bytes() == content
    page.get_by_role("button", name="Rename", exact=True).click()
    page.get_by_label("New name").fill("other.csv")
    page.get_by_label("New name").press("Enter")
    actions = page.get_by_role("group", name="The chosen file")
    expect(actions.get_by_role("heading")).to_have_text("other.csv")
    with page.expect_download() as kept:
        actions.get_by_role("button", name="Download").click()
    assert kept.value.suggested_filename == "other.csv"
    assert kept.value.path().read_bytes() == content
    actions.get_by_role("button", name="Find a model of the arm").click()
    form = page.locator(".verb-form")
    expect(form.locator("[name=logs][value='other.csv']")).to_be_checked()
    expect(form.locator("[name=logs][value='kept.csv']")).not_to_be_checked()
    page.get_by_role("button", name="Files", exact=True).click()
    for answer, stays in (("Keep it", True), ("Delete it", False)):
        actions.get_by_role("button", name="Delete", exact=True).click()
        page.get_by_role("button", name=answer).click()
        expect(page.get_by_role("button", name="other.csv")).to_have_count(int(stays))
        assert (folder / "other.csv").is_file() is stays


def test_a_recording_of_the_view_live_is_in_the_folder(shared_page: Page, stage: Stage) -> None:
    page = shared_page
    page.get_by_role("button", name="Live", exact=True).click()
    page.get_by_role("button", name="Record", exact=True).click()
    stage.live(0.2)
    page.wait_for_function(f"() => Number(document.querySelector('.live').dataset.tick) >= {stage.newest().tick}")
    page.get_by_role("button", name="End recording").click()
    said = page.get_by_role("alert").filter(has_text=f"is in {stage.folder}, and in the view Files.")
    expect(said).to_be_visible()
    (file,) = stage.folder.glob("recording-*.csv")
    assert read_log(file).time.size > 100


def require_an_error_beside_a_log(page: Page) -> None:
    page.get_by_role("button", name="Files", exact=True).click()
    for name in ("late.csv", "bad.csv"):
        page.get_by_role("button", name=name).click()
    told = page.get_by_role("alert").first
    expect(told).to_contain_text("bad.csv, line")
    expect(told).to_contain_text("'<b>x</b>' is not one of boot, disabled")
    expect(page.get_by_role("button", name="late.csv")).to_have_attribute("aria-pressed", "true")
    expect(page.get_by_role("button", name="bad.csv")).to_have_attribute("aria-pressed", "false")


def test_episodes_are_begun_ended_and_discarded_by_keys(page: Page, stage: Stage) -> None:
    task = 'Put the "Würfel", then \U0001f95b'
    page.get_by_role("button", name="Live", exact=True).click()
    write(stage.folder / "episode_006.csv", 40)
    card = page.locator(".card").filter(has_text="Episodes")
    page.locator("main").focus()
    page.keyboard.press("r")
    expect(page.get_by_role("alert").filter(has_text="An episode has a task")).to_be_visible()
    card.get_by_label("Task").fill(task + "r")  # a letter in a field is no key
    card.get_by_label("Task").press("Backspace")
    page.locator("main").focus()

    def record(end: str) -> None:
        page.keyboard.press("r")
        expect(card.get_by_role("button", name="End episode")).to_be_visible()
        stage.live(0.2)
        page.wait_for_function(f"() => Number(document.querySelector('.live').dataset.tick) >= {stage.newest().tick}")
        page.keyboard.press(end)

    for kept in ("episode_007.csv", "episode_008.csv"):
        record("r")
        expect(card).to_contain_text(f"the last is {kept}.")
        log = read_log(stage.folder / kept)
        assert (log.origin.task, log.complete, log.condition.check) == (task, True, Check.WHOLE)
        assert log.time.size >= 200
    page.keyboard.press("d")
    expect(card).to_contain_text("1 kept, the last is episode_007.csv.")
    record("d")
    expect(card.get_by_role("button", name="Begin episode")).to_be_visible()
    record("r")
    expect(card).to_contain_text("2 kept, the last is episode_008.csv.")
    stage.hold(20)
    page.get_by_role("button", name="Enable").click()
    await_state(page, "following")
    page.locator("main").focus()
    page.keyboard.press("r")
    stage.command("pot follower 1 open")
    expect(card).to_contain_text("3 kept, the last is episode_009.csv.")
    log = read_log(stage.folder / "episode_009.csv")
    assert (log.complete, log.state[-1]) == (False, "fault")
    assert log.ended_by.startswith("The board is in fault: a potentiometer reads at ")
    assert sorted(path.name for path in stage.folder.glob("episode_*")) == [f"episode_00{n}.csv" for n in (6, 7, 8, 9)]
    stage.command("pot follower 1 connected")
    stage.live(0.1)  # the fault cannot be cleared while the potentiometer still reads at its end
    page.get_by_role("button", name="Clear fault").click()
