"""Verbs from the page: the same results and errors as in the terminal, and the page shows both."""

from __future__ import annotations

import json
import threading
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from playwright.sync_api import Page, expect

from greywhale.board.calibrate.words import sweep_asked
from greywhale.commission.measures import NAMES, Measures
from greywhale.commission.motions import PARTS
from greywhale.dashboard.job import Facts
from greywhale.dashboard.jobs import Listed
from greywhale.files.log import read_log
from tests.page.stage import PATIENCE_MS, Stage

pytestmark = pytest.mark.slow


def test_a_recording_from_the_page_is_a_log_and_its_errors_are_sentences(
    page: Page, stage: Stage, tmp_path: Path
) -> None:
    page.get_by_role("button", name="Do", exact=True).click()
    page.get_by_role("button", name="record", exact=True).click()
    page.get_by_label("out", exact=True).fill("first.csv")
    page.get_by_label("seconds", exact=True).fill("1")
    page.get_by_role("button", name="Start record").click()
    job = page.locator(".job").first
    expect(job.get_by_role("status")).to_have_text("done")
    rows = len(read_log(tmp_path / "first.csv").time)
    assert rows > 900
    expect(job.locator(".result")).to_contain_text(str(rows))
    page.get_by_role("button", name="evaluate", exact=True).click()
    page.get_by_label("logs", exact=True).fill("none.csv")
    page.get_by_role("button", name="Start evaluate").click()
    failed = page.locator(".job").first
    expect(failed.get_by_role("status")).to_have_text("failed")
    expect(failed.get_by_role("alert")).to_contain_text("none.csv")


def test_the_view_says_that_it_reads_the_verbs_until_they_are_there(
    page: Page, stage: Stage, monkeypatch: pytest.MonkeyPatch
) -> None:
    ready, listed = threading.Event(), stage.jobs.listed

    def listed_later() -> Listed:
        ready.wait(PATIENCE_MS / 1000)
        return listed()

    monkeypatch.setattr(stage.jobs, "listed", listed_later)
    page.get_by_role("button", name="Do", exact=True).click()
    reading = page.get_by_text("Reading what can be done ...")
    expect(reading).to_be_visible()
    ready.set()
    expect(page.get_by_role("button", name="record", exact=True)).to_be_visible()
    expect(reading).to_be_hidden()


def test_a_search_draws_its_curve_while_it_runs_and_each_joints_at_its_end(page: Page, stage: Stage) -> None:
    page.get_by_role("button", name="Do", exact=True).click()
    page.get_by_role("button", name="tune", exact=True).click()
    page.get_by_label("model file", exact=True).fill("default")
    page.locator(".verb-form summary").click()
    page.get_by_label("budget", exact=True).fill("40")
    page.get_by_label("force", exact=True).check()
    page.get_by_role("button", name="Start tune").click()
    job = page.locator(".job").first
    expect(job.locator("figcaption")).to_contain_text("Best cost so far: ")
    expect(job.locator("polyline.accent")).to_have_count(1)
    expect(job.get_by_role("status")).to_have_text("done")
    for joint, curve in enumerate(stage.jobs.facts()[-1]["result"]["curves"]):
        drawn = job.locator(f"polyline.joint-{joint}").get_attribute("points")
        assert drawn is not None
        depths = [float(point.split(",")[1]) for point in drawn.split()]
        assert len(depths) == len(curve["evaluations"]) > 2
        assert depths[int(np.argmin(curve["cost"]))] == max(depths), "the lower on the screen, the better"


def facts_of(verb: str) -> Facts:
    """A job that runs."""
    return {
        "kind": "job", "id": "c", "verb": verb, "arguments": {}, "state": "running", "progress": None,
        "result": None, "error": None, "exit_code": None, "said": [],
    }  # fmt: skip


def tell(stage: Stage, facts: Facts) -> None:
    """The only job is so now: for a page that hears of it, and for one that is still about to ask."""
    stage.jobs.facts = lambda: [facts]  # type: ignore[method-assign]
    for listener in stage.jobs.listeners:
        listener(facts)


def test_a_calibration_shows_the_way_of_the_joint_that_it_asks_for(page: Page, stage: Stage) -> None:
    page.get_by_role("button", name="Do", exact=True).click()
    facts = facts_of("calibrate")
    pictures = []
    for pot in range(2):
        tell(stage, {**facts, "said": [sweep_asked(pot, pot + 1, 8)]})
        shown = page.get_by_role("img", name=f"The positive way of joint {pot}")
        expect(shown).to_be_visible()
        pictures.append(shown.screenshot())
    assert pictures[0] != pictures[1]
    tell(stage, {**facts, "state": "done", "result": {}, "exit_code": 0, "said": [sweep_asked(1, 2, 8)]})
    expect(shown).to_be_hidden()


def test_a_commissioning_shows_what_was_predicted_beside_what_was_measured(page: Page, stage: Stage) -> None:
    def told(mrad: float) -> dict[str, Any]:
        sizes = np.add.outer(np.arange(len(PARTS)), np.arange(4) + mrad) / 1000
        return dict(Measures(**dict.fromkeys(NAMES, sizes**2)).as_dict())

    unplayed = json.loads(json.dumps(told(7.0)).replace("4.9e-05", "null"))
    trials = [
        {"trial": "before", "predicted": told(30.0), "measured": told(32.5)},
        {"trial": "trial-1", "predicted": told(5.0), "measured": unplayed},
    ]
    facts = facts_of("commission")
    note = "trial-1: error 6.1 mrad rms predicted, 7.2 measured"
    progress = {"done": 0.5, "total": 1.0, "text": "round 1, trial 2 of 6 at most: recording", "note": note}
    page.get_by_role("button", name="Do", exact=True).click()
    tell(stage, {**facts, "progress": progress})
    expect(page.get_by_text(f"{progress['text']} ({note})")).to_be_visible()
    tell(stage, {**facts, "state": "done", "result": {"improved": True, "trials": trials}, "exit_code": 0})
    table = page.get_by_role("region", name="Predicted and measured")
    rows = table.locator("tbody tr")
    expect(rows.nth(0).locator("td")).to_have_text([f"{30 + joint}.0 / {32 + joint}.5" for joint in range(4)])
    expect(rows.nth(1).locator("td").first).to_have_text("5.0 / –")
    table.get_by_label("Part of the check").select_option(PARTS[2])
    expect(rows.nth(0).locator("td").first).to_have_text("32.0 / 34.5")
    table.get_by_label("Measure").select_option("unrest")
    expect(rows.nth(0).locator("td").first).to_have_text("1.02 / 1.19")
