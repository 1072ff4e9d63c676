"""Verbs from the page: the same results and errors as in the terminal, and the page shows both."""

from __future__ import annotations

import json
import threading
from collections.abc import Callable
from typing import Any, cast

import numpy as np
import pytest
from playwright.sync_api import BrowserContext, Locator, Page, expect

from greywhale.base.telling import Telling
from greywhale.commission.measures import NAMES, Measures
from greywhale.commission.motions import PARTS
from greywhale.dashboard.client import Client
from greywhale.dashboard.job import Facts, ProgressFacts
from greywhale.dashboard.jobs import Listed
from greywhale.files.arm import load_arm
from greywhale.files.log import read_log
from greywhale.protocol.schema import DEFAULTS, PARAMETER_BY_NAME
from tests.cli.example_log import write_log
from tests.page import stage as stages
from tests.page.barriers import DARK_AND_NARROW, LIGHT_AND_WIDE, require_no_barrier
from tests.page.stage import PATIENCE_MS, Stage
from tests.support.tellings import told_by_verbs, words

__all__ = ["told_by_verbs"]
pytestmark = pytest.mark.slow

KP = PARAMETER_BY_NAME["joint0.kp"]


@pytest.fixture
def desk(shared_page: Page) -> Page:
    """A page that shows the verbs, and the cards of jobs that other tests had."""
    shared_page.get_by_role("button", name="Do", exact=True).click()
    return shared_page


def form_of(desk: Page, verb: str) -> Locator:
    """The form of a verb, opened anew."""
    desk.locator(f"[data-verb='{verb}']").click()
    form = desk.locator(".verb-form").filter(has=desk.locator("h2 code", has_text=verb))
    form.wait_for()
    return form


def begin(desk: Page, verb: str, **given: str | bool) -> Locator:
    """Start a verb by its form; its card."""
    form = form_of(desk, verb)
    form.locator("details").evaluate_all("all => all.forEach((one) => { one.open = true; })")
    for name, value in given.items():
        field = form.locator(f"[name='{name}']").first
        kind = field.evaluate("one => one.type")
        if kind == "checkbox":
            form.locator(f"[name='{name}']" if value is True else f"[name='{name}'][value='{value}']").check()
        elif kind == "select-one":
            field.select_option(str(value))
        else:
            field.fill(str(value))
    start = form.get_by_role("button", name=f"Start {verb}", exact=True)
    cards = desk.locator(".job").filter(has=desk.get_by_role("heading", name=verb, exact=True))
    before = cards.count()
    start.click()
    expect(cards).to_have_count(before + 1)
    return cards.first


def end(job: Locator, state: str) -> Locator:
    """Wait for its end, which must be this one; its card."""
    status = job.get_by_role("status").element_handle()
    job.page.wait_for_function("status => status.textContent !== 'running'", arg=status, polling=50)
    assert job.get_by_role("status").inner_text() == state, job.inner_text()
    return job


def done(job: Locator) -> Locator:
    """Its result, when it has one."""
    return end(job, "done").locator(".result")


def failed(job: Locator) -> Locator:
    """Its one sentence."""
    return end(job, "failed").get_by_role("alert")


# Notes on the card what the curve of a search shows while that runs.
SEE = """card => {
  card.seen = new Set();
  new MutationObserver(() => {
    const words = card.querySelector("figcaption").textContent.split(":")[0];
    const running = card.querySelector("[role=status]").textContent === "running";
    if (running && words) card.seen.add(`${card.querySelectorAll("polyline.accent").length} curve, ${words}`);
  }).observe(card, { childList: true, subtree: true, characterData: true });
}"""


@pytest.fixture(scope="module")
def search(shared_page: Page) -> Locator:
    """The card of a search that runs while other tests are at work."""
    shared_page.get_by_role("button", name="Do", exact=True).click()
    card = begin(shared_page, "tune", model_file="default", budget="12", force=True)
    card.evaluate(SEE)
    return card


def test_verbs_end_with_their_result_or_their_sentence(search: Locator, desk: Page, stage: Stage) -> None:
    folder = stage.folder
    stage.command("hold 20")
    record = begin(desk, "record", out="first.csv", seconds="0.5", enable=True)
    result = done(record)
    rows = len(read_log(folder / "first.csv").time)
    assert rows > 400
    expect(result.get_by_label("Result")).to_contain_text(f"{rows}")
    expect(result.locator("details")).not_to_have_attribute("open", "")
    identify = begin(desk, "identify", logs="first.csv")  # which needs no board
    (folder / "led.csv").write_text("time_s,leader_0,leader_1,leader_2,leader_3\n0,0,0,0,0\n1,0.2,0,0,0\n")
    replayed = done(begin(desk, "replay", motion="led.csv", out="second.csv"))
    picture = replayed.get_by_role("img", name="Leader and follower of joint 2, wrist pitch")
    expect(picture.locator("polyline")).to_have_count(2)
    replayed.get_by_role("button", name="Measure how well it followed").click()
    expect(desk.locator("[name='logs'][value='second.csv']")).to_be_checked()
    expect(desk.get_by_role("button", name="Start evaluate")).to_be_focused()
    led = read_log(folder / "second.csv")
    assert led.leader[-1, 0] == pytest.approx(0.2, abs=0.001)
    assert set(np.diff(np.round(1000 * led.time))) == {1}
    expect(done(begin(desk, "upload", controller="table_8", yes=True))).to_contain_text("joint0.kp")
    desk.get_by_role("button", name="Controller", exact=True).click()  # which follows
    raw = stage.answers.controller("table_8")["raw"][KP.name]
    assert raw != DEFAULTS[KP.index]
    expect(desk.get_by_label("Kp 1/rad")).to_have_value(f"{KP.to_physical(raw):.4g}")
    expect(desk.get_by_text("The board has stored these controllers.")).to_be_visible()
    desk.get_by_role("button", name="Do", exact=True).click()
    expect(failed(identify)).to_contain_text("first.csv: only 0.")
    expect(identify.get_by_label("What the verb says")).to_be_hidden()  # which is the same sentence


# The sentences and tables of a card's result, without what stands there for its pictures and buttons.
TOLD = """card => [...card.querySelector(".told").children].filter((one) => !one.matches("figure, .next, .beside"))
  .map((one) => one.innerText).join("\\n")"""


def test_a_result_says_what_a_terminal_says(
    desk: Page, stage: Stage, tell: Callable[[Facts], None], told_by_verbs: dict[str, tuple[Telling, str]]
) -> None:
    for log in ("log.csv", "record.csv", "replay.csv"):  # that are drawn
        write_log(stage.folder / log)
    for verb, (telling, printed) in told_by_verbs.items():
        facts = {**facts_of(f"told {verb}"), "state": "done", "result": {}, "telling": telling.as_dict()}
        tell(cast(Facts, facts))
        card = desk.locator(".job").filter(has=desk.get_by_role("heading", name=f"told {verb}", exact=True))
        assert words(card.evaluate(TOLD)) == words(printed), verb
        buttons = card.get_by_role("group", name="Next").get_by_role("button")
        assert buttons.all_inner_texts() == [step.words for step in telling.steps], verb
        if verb not in ("doctor", "evaluate", "commission"):  # these stay for the test of barriers
            card.evaluate("card => card.remove()")
    doctor = desk.locator(".job").filter(has=desk.get_by_role("heading", name="told doctor", exact=True))
    evaluate = desk.locator(".job").filter(has=desk.get_by_role("heading", name="told evaluate", exact=True))
    expect(evaluate.get_by_role("columnheader", name="MSE rad²").first).to_be_visible()
    calibration = doctor.get_by_role("row").filter(has_text="calibration")
    expect(calibration.locator(".below code")).to_have_text("greywhale calibrate")


def test_a_search_draws_its_curve_while_it_runs_and_each_joints_at_its_end(search: Locator, stage: Stage) -> None:
    done(search)
    assert search.evaluate("card => [...card.seen]") == ["1 curve, Best cost so far"]
    result = next(facts["result"] for facts in stage.jobs.facts() if facts["verb"] == "tune")
    for joint, curve in enumerate(result["curves"]):
        drawn = search.locator(f"polyline.joint-{joint}").get_attribute("points")
        assert drawn is not None
        depths = [float(point.split(",")[1]) for point in drawn.split()]
        assert len(depths) == len(curve["evaluations"]) > 2
        expect(search.get_by_role("img", name=f"Sets of joint {joint}, before and after")).to_be_visible()
        assert depths[int(np.argmin(curve["cost"]))] == max(depths), "the lower on the screen, the better"


def test_a_form_says_beside_its_field_what_is_wrong(desk: Page, stage: Stage) -> None:
    before = [facts["id"] for facts in stage.jobs.facts()]
    form = form_of(desk, "record")
    seconds = form.get_by_label("Time to record, s", exact=True)
    seconds.fill("a while")
    form.get_by_role("button", name="Start record", exact=True).click()
    expect(form.get_by_role("alert")).to_have_text('Time to record is "a while", but it must be a number.')
    expect(seconds).to_be_focused()
    assert [facts["id"] for facts in stage.jobs.facts()] == before
    card = begin(desk, "record", out="none.csv", seed="3")
    failed(card)
    said = '"Seed of the random numbers" belongs to "Let greywhale lead the arm"; add that, or leave it out.'
    expect(form.get_by_role("alert")).to_have_text(said)
    expect(form.get_by_label("Seed of the random numbers", exact=True)).to_be_focused()
    form.get_by_label("Seed of the random numbers", exact=True).fill("4")
    card.get_by_role("button", name="Change and repeat").click()
    expect(form.get_by_label("Seed of the random numbers", exact=True)).to_have_value("3")
    card.get_by_role("button", name="Put away").click()
    expect(desk.get_by_text("belongs to --excite")).to_have_count(0)


def test_an_arm_is_described_by_answers_to_its_questions(desk: Page, stage: Stage) -> None:
    form = form_of(desk, "arm new")
    form.get_by_text("Link 1, the upper arm").click()
    length = form.locator("[name='link[1].length_mm']")
    length.fill("long")
    form.locator("[name='link[1].section']").select_option("bar")
    form.locator("[name='link[1].height_mm']").fill("12")
    expect(form.get_by_role("alert")).to_have_text("Its length: that is no number.")
    start = form.get_by_role("button", name="Start arm new", exact=True)
    start.click()
    expect(length).to_be_focused()
    length.fill("15 cm")
    length.blur()
    expect(form.get_by_role("alert")).to_have_count(0)
    start.click()
    card = desk.locator(".job").filter(has=desk.get_by_role("heading", name="arm new", exact=True))
    expect(done(card)).to_contain_text("arm.toml is written")
    assert load_arm(stage.folder / "arm.toml").link[1].length == pytest.approx(0.15)
    expect(form.locator("[name=out]")).to_have_value("arm-2.toml")  # the next that is free
    expect(done(begin(desk, "arm match", arm="arm.toml"))).to_contain_text("matched.toml is written")


def facts_of(verb: str) -> Facts:
    """A job that runs."""
    return {
        "kind": "job", "id": verb, "verb": verb, "arguments": {}, "state": "running", "progress": None,
        "countdown": 0, "telling": None, "result": None, "error": None, "exit_code": None, "said": [],
    }  # fmt: skip


@pytest.fixture
def tell(stage: Stage, monkeypatch: pytest.MonkeyPatch) -> Callable[[Facts], None]:
    """The only job is so now: for a page that hears of it, and for one that is still about to ask."""

    def tell(facts: Facts) -> None:
        monkeypatch.setattr(stage.jobs, "facts", lambda: [facts])
        for listener in stage.jobs.listeners:
            listener(facts)

    return tell


def test_a_commissioning_shows_what_was_predicted_beside_what_was_measured(
    desk: Page, tell: Callable[[Facts], None]
) -> None:
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
    progress: ProgressFacts = {
        "done": 0.5,
        "total": 1.0,
        "text": "round 1, trial 2 of 6 at most: recording",
        "note": note,
    }
    tell({**facts, "progress": progress})
    expect(desk.get_by_text(f"{progress['text']} ({note})")).to_be_visible()
    tell({**facts, "state": "done", "result": {"improved": True, "trials": trials}, "exit_code": 0})
    table = desk.get_by_role("region", name="Predicted and measured")
    rows = table.locator("tbody tr")
    expect(rows.nth(0).locator("td")).to_have_text([f"{30 + joint}.0 / {32 + joint}.5" for joint in range(4)])
    expect(rows.nth(1).locator("td").first).to_have_text("5.0 / –")
    table.get_by_label("Part of the check").select_option(PARTS[2])
    expect(rows.nth(0).locator("td").first).to_have_text("32.0 / 34.5")
    table.get_by_label("Measure").select_option("unrest")
    expect(rows.nth(0).locator("td").first).to_have_text("1.02 / 1.19")


def test_a_verb_that_cannot_start_says_why_as_long_as_that_holds(
    context: BrowserContext, desk: Page, stage: Stage
) -> None:
    with stages.visit(context, stage) as watcher:
        watcher.page.get_by_role("button", name="Do", exact=True).click()
        reason = watcher.page.locator(".verb-form .reason")
        for verb, needs in (("record", True), ("evaluate", False), ("flash", True)):
            start = form_of(watcher.page, verb).get_by_role("button", name=f"Start {verb}", exact=True)
            expect(start).to_be_disabled() if needs else expect(start).to_be_enabled()
            expect(reason).to_have_text("Another page drives this arm; let go there first." if needs else "")
        desk.get_by_role("button", name="Let go").click()
        expect(reason).to_contain_text("choose `Take control` first")
        watcher.page.get_by_role("button", name="Take control").click()
        expect(start).to_be_enabled()
        expect(reason).to_be_hidden()
        watcher.page.get_by_role("button", name="Let go").click()
        desk.get_by_role("button", name="Take control").click()
        expect(reason).to_be_visible()


def test_the_count_before_the_arm_moves_stands_over_every_view_and_is_stopped_there(
    desk: Page, stage: Stage, tell: Callable[[Facts], None], monkeypatch: pytest.MonkeyPatch
) -> None:
    asked: list[str] = []
    stopped = stage.relay.stopped

    def note(where: str, by: Client | None = None) -> None:
        asked.append(where)
        stopped(where, by)

    monkeypatch.setattr(stage.relay, "stopped", note)
    field = form_of(desk, "replay").locator("[name='out']")
    before = field.input_value()
    count = desk.get_by_role("alertdialog")

    def space_where_a_person_writes() -> None:
        field.focus()
        desk.keyboard.press("Space")

    button = count.get_by_role("button", name="Stop")
    stops: list[Callable[[], object]] = [
        *(button.click, space_where_a_person_writes, lambda: desk.keyboard.press("Enter")),
    ]
    for number, stop in enumerate(stops):
        facts: Facts = {**facts_of("replay"), "id": f"replay {number}"}
        for left in (3, 2):
            tell({**facts, "countdown": left})
            expect(count.locator(".seconds")).to_have_text(str(left))
        expect(button).to_be_focused()
        stop()
        stage.wait_for(lambda: asked == ["from the page that drives"])
        asked.clear()
        tell({**facts, "state": "stopped", "error": "Stopped from the page that drives."})
        expect(count).to_be_hidden()
    expect(field).to_have_value(before)


# Notes the page's sockets, so that a test can close them.
SOCKETS = """{
  const Usual = WebSocket;
  window.sockets = [];
  window.WebSocket = class extends Usual {
    constructor(...given) {
      super(...given);
      window.sockets.push(this);
    }
  };
}"""


def test_a_count_ends_with_the_server_that_told_of_it(
    context: BrowserContext, stage: Stage, tell: Callable[[Facts], None]
) -> None:
    with stages.visit(context, stage, SOCKETS) as visit:
        visit.page.locator(".pill", has_text="disabled").wait_for()
        tell({**facts_of("replay"), "countdown": 3})
        count = visit.page.get_by_role("alertdialog")
        expect(count).to_be_visible()
        visit.page.evaluate("() => { for (const one of sockets) one.close(); }")
        expect(count).to_be_hidden()
    tell({**facts_of("replay"), "state": "stopped"})  # for other pages


def test_nothing_bars_a_person(shared_page: Page) -> None:
    require_no_barrier(shared_page, LIGHT_AND_WIDE, DARK_AND_NARROW)


def test_the_view_says_that_it_reads_the_verbs_until_they_are_there(
    shared_page: Page, stage: Stage, monkeypatch: pytest.MonkeyPatch
) -> None:
    page, jobs, ready = shared_page, stage.jobs, threading.Event()
    listed = jobs.listed

    def listed_later() -> Listed:
        ready.wait(PATIENCE_MS / 1000)
        return listed()

    monkeypatch.setattr(jobs, "listed", listed_later)
    page.reload()
    page.get_by_role("button", name="Do", exact=True).click()
    reading = page.get_by_text("Reading what can be done ...")
    expect(reading).to_be_visible()
    ready.set()
    expect(page.get_by_role("button", name="Record a log", exact=True)).to_be_visible()
    expect(reading).to_be_hidden()
