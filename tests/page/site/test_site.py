"""The page with a bench inside, as a folder or one file: what a first visitor sees and does, with no other network."""

from __future__ import annotations

import re
import shutil
from collections.abc import Iterator
from contextlib import ExitStack
from dataclasses import dataclass, replace
from pathlib import Path
from urllib.parse import parse_qsl

import pytest
from playwright.sync_api import BrowserContext, Page, expect

from greywhale.files.log import read_log
from tests.page import stage as stages
from tests.page.barriers import DARK_AND_NARROW, require_no_barrier
from tests.page.drag import drag, value_of
from tests.page.site.serve_folder import Site, serve
from tests.page.stage import await_state
from tools import ROOT
from tools.docs.links import anchors

pytestmark = pytest.mark.slow

STOP_AT_ONCE = """new MutationObserver((_, watch) => {
  const stop = document.querySelector("button.stop");
  if (!stop) return;
  watch.disconnect();
  stop.click();
}).observe(document, { childList: true, subtree: true })"""
RECORDING = "time_s,leader_0,leader_1,leader_2,leader_3\n0,0.5,0.4,0,0\n60,0.5,0.4,0,0\n"
ONLY_KEPT = """(build) => {
  caches.keys().then((names) => { window.kept = names.join(); });
  return window.kept?.lastIndexOf("greywhale") === 0 && window.kept.endsWith(build);
}"""
KEPT, ASIDE = "greywhale-eeprom-mega", "greywhale-eeprom-damaged"


@dataclass(frozen=True)
class OnDisk:
    """The page as one file, which no server hands out."""

    page_address: str
    port: int = 0


def state_of(fragment: str) -> dict[str, float | str]:
    """What a link says of the page, numbers as such."""
    return {key: float(text) if re.fullmatch(r"[-.\d]+", text) else text for key, text in parse_qsl(fragment)}


@pytest.fixture
def visited(context: BrowserContext, site: Site, request: pytest.FixtureRequest) -> Iterator[Page]:
    """A page that somebody opens for the first time, in the view that is asked for."""
    with stages.visit(context, replace(site, said=getattr(request, "param", ""))) as visit:
        yield visit.page


def opened(view: str) -> pytest.MarkDecorator:
    """A test that does not look at the arm: to draw it costs more than all else on the page."""
    return pytest.mark.parametrize("visited", [f"#view={view}"], indirect=True)


def test_a_visitor_sees_an_arm_that_follows_and_what_needs_a_host_is_not_there(visited: Page) -> None:
    views = ["Start", "Live", "Controller", "Parameters", "Calibrate", "Bench"]
    expect(visited.locator("nav button")).to_have_text(views)
    expect(visited.get_by_text("an Arduino Mega and an arm, simulated in this page", exact=True)).to_be_visible()
    require_things_to_try(visited)
    visited.get_by_role("button", name="Live").click()
    visited.wait_for_function(
        """() => [...document.querySelectorAll(".values tbody tr")].some((row) => {
          const [leader, follower] = [...row.querySelectorAll("td")].slice(-4).map((cell) => Number(cell.innerText));
          return Math.abs(leader) > 0.3 && Math.abs(leader - follower) < 0.1;
        })"""
    )
    visited.get_by_role("button", name="Bench").click()
    expect(visited.get_by_role("button", name="Hold still")).to_be_visible()
    expect(visited.get_by_label("Speed of time, ×")).to_be_visible()
    expect(visited.get_by_label("Recorded motion")).to_have_count(0)
    visited.get_by_text("Play a recording").click()
    visited.get_by_label("A recording (CSV)").set_input_files(
        {"name": "hand.csv", "mimeType": "text/csv", "buffer": RECORDING.encode()}
    )
    visited.get_by_role("button", name="Play the recording").click()
    expect(visited.get_by_label("Leader, base yaw, rad")).to_have_value("0.5")
    visited.get_by_role("button", name="Reach here and there").click()
    expect(visited.get_by_role("button", name="Play the recording")).to_be_visible()
    visited.keyboard.press("Space")
    await_state(visited, "disabled")


def require_things_to_try(visited: Page) -> None:
    """Each says what happened, and where to read more."""
    expect(visited.locator(".try h2")).to_have_text(["Pull the leader", "Break a wire", "Let it tune"])
    said = visited.locator(".try p[role=status]:visible")
    await_state(visited, "following")
    expect(said).to_have_count(0)
    visited.get_by_role("button", name="Pull the shoulder").click()
    expect(said).to_have_count(1)
    visited.get_by_role("button", name="Break the wire").click()
    await_state(visited, "fault")
    visited.get_by_role("button", name="Mend it and go on").click()
    await_state(visited, "following")
    visited.get_by_role("button", name="Let it reach on").click()
    expect(visited.get_by_role("button", name="Pull the shoulder")).to_be_visible()
    visited.get_by_role("button", name="Let it tune").click()
    expect(visited.get_by_text("Control surface")).to_be_visible()
    expect(visited.get_by_text("This is the arm as the page begins with it")).to_be_visible()
    visited.locator(".predict[data-rms]").wait_for()
    expect(visited.get_by_text("Against a file")).to_have_count(0)
    visited.get_by_role("button", name="Start", exact=True).click()
    expect(said).to_have_count(3)
    for more in said.get_by_role("link").all():
        page, _, anchor = (more.get_attribute("href") or "").removeprefix("docs/").partition("#")
        there = ROOT / "docs" / page.replace(".html", ".md")
        assert there.is_file()
        assert anchor in {"", *anchors(there)}


def test_a_lesson_opens_in_the_state_that_its_link_names(context: BrowserContext, site: Site) -> None:
    text = (ROOT / "docs" / "lessons.md").read_text("utf-8")
    lessons = [re.findall(r"\]\(page:([^)]+)\)", lesson)[-1] for lesson in text.split("\n## ")[1:]]
    assert len(lessons) == 4
    first, second = lessons[1::2]  # a controller's, a motion's; Node reads the links of all
    with stages.visit(context, replace(site, said=f"#{first}")) as visit:
        page = visit.page
        for lesson in (first, second):
            if lesson == second:
                page.goto("about:blank")
                page.goto(f"{site.page_address}#{lesson}")
            page.get_by_role("button", name="Copy link").click()
            expect(page.locator(".notice")).to_contain_text("link is")
            assert state_of(page.url.partition("#")[2]) == {"joint": 0, **state_of(lesson)}
        page.evaluate("location.hash = 'view=live&noise=99'")
        expect(page.locator(".notice")).to_have_text(
            re.compile('set aside, for noise is "99": choose a number from 0 to 10.')
        )
        await_state(page, "following")


def test_who_stops_before_the_arm_has_moved_is_obeyed(context: BrowserContext, site: Site, tmp_path: Path) -> None:
    with stages.visit(context, replace(site, said="#view=live"), STOP_AT_ONCE) as visit:
        visit.page.wait_for_function("document.querySelector('.live')?.dataset.tick > 600")
        with visit.page.expect_download() as saved:
            visit.page.get_by_role("button", name="Save view").click()
        saved.value.save_as(tmp_path / "view.csv")
    assert set(read_log(tmp_path / "view.csv").state) == {"disabled"}


def begin_to_tune(page: Page) -> None:
    """Until the search, which runs beside the page, has told of itself."""
    page.get_by_role("button", name="Controller", exact=True).click()
    page.get_by_role("button", name="Tune", exact=True).click()
    expect(page.get_by_text("of 500 sets")).to_be_visible()


@opened("controller")
def test_who_lets_the_page_tune_sees_the_course_and_runs_what_was_found(visited: Page) -> None:
    await_state(visited, "following")
    visited.get_by_role("button", name="Controller", exact=True).click()
    drag(visited, "Pe_b", 0.1)
    begin_to_tune(visited)
    visited.get_by_role("button", name="Stop the search").click()
    expect(visited.get_by_text("Found; Apply runs it.")).to_be_visible()
    expect(visited.get_by_role("region", name="What the tuning changed").get_by_role("row")).to_have_count(5)
    expect(visited.get_by_label("Curve of the search")).to_be_visible()
    expect(visited.get_by_label("The same hand, followed before and after")).to_be_visible()
    visited.get_by_role("button", name="Apply").click()
    expect(visited.get_by_text("The board runs these controllers.")).to_be_visible()
    await_state(visited, "following")
    require_no_barrier(visited, DARK_AND_NARROW)


def test_one_file_alone_opens_from_a_disk_and_tunes(context: BrowserContext, folder: Path, tmp_path: Path) -> None:
    alone = (folder / "greywhale.html").rename(tmp_path / "alone.html")
    with stages.visit(context, OnDisk(alone.as_uri())) as visit:
        await_state(visit.page, "following")
        visit.page.locator("canvas").first.wait_for()
        begin_to_tune(visit.page)


def test_it_opens_without_a_network_after_the_first_visit_and_a_new_build_shows_at_once(
    context: BrowserContext, folder: Path, tmp_path: Path
) -> None:
    own = shutil.copytree(folder, tmp_path / "site")
    with ExitStack() as online, ExitStack() as visits:
        served = replace(online.enter_context(serve(own)), said="#view=live")
        page = visits.enter_context(stages.visit(context, served)).page
        page.evaluate("navigator.serviceWorker.ready.then(() => null)")
        new = build_anew(own)
        page.reload()
        expect(page).to_have_title("anew")
        page.wait_for_function(ONLY_KEPT, arg=new)
        online.close()
        page.reload()
        expect(page).to_have_title("anew")
        await_state(page, "following")
        page.get_by_role("button", name="Start", exact=True).click()  # not looked at while there was a network
        page.locator("canvas[data-tick]").wait_for()


def build_anew(folder: Path) -> str:
    """Another build with another title; the folder of its parts."""
    (old,) = (path for path in folder.iterdir() if path.is_dir())
    new = old.name[::-1]
    old.rename(folder / new)
    for name in ("index.html", "offline.js"):
        text = (folder / name).read_text("utf-8")
        (folder / name).write_text(
            text.replace(old.name, new).replace("<title>greywhale", "<title>anew"), encoding="utf-8"
        )
    return new


def test_what_is_stored_is_there_after_a_reload_unless_it_is_damaged(visited: Page) -> None:
    await_state(visited, "following")
    visited.get_by_role("button", name="Stop").click()
    visited.get_by_role("button", name="Controller", exact=True).click()
    drag(visited, "Pe_b", 0.1)
    dragged = value_of(visited, "Pe_b")
    visited.get_by_role("button", name="Apply").click()
    expect(visited.get_by_text("The board runs these controllers.")).to_be_visible()
    visited.get_by_role("button", name="Store").click()
    expect(visited.get_by_text("The board has stored these controllers.")).to_be_visible()
    visited.reload()
    visited.get_by_role("button", name="Controller", exact=True).click()
    visited.get_by_role("slider", name="Pe_b", exact=True).wait_for()
    assert value_of(visited, "Pe_b") == pytest.approx(dragged, abs=1e-4)
    expect(visited.get_by_text("The board has stored these controllers.")).to_be_visible()
    visited.evaluate("([key, text]) => localStorage.setItem(key, text)", [KEPT, "no memory"])
    visited.reload()
    expect(visited.locator(".notice")).to_contain_text("is damaged; it is set aside")
    assert visited.evaluate("(key) => localStorage.getItem(key)", ASIDE) == "no memory"


LOOP = ":02000000FFCF30\n:00000001FF\n"  # a program that does nothing, for ever


@opened("bench")
def test_the_board_in_the_page_takes_firmware_through_its_bootloader(visited: Page, tmp_path: Path) -> None:
    """An image for another chip is refused, and leaves the board as it was; a reload brings the page's own."""
    await_state(visited, "following")
    visited.get_by_role("button", name="Stop", exact=True).click()
    file = visited.get_by_label("A HEX file in its place")
    flash = visited.get_by_role("button", name="Flash", exact=True)
    file.set_input_files(ROOT / "firmware/.pio/build/nanoatmega328/firmware.hex")
    flash.click()
    expect(visited.locator(".notice")).to_contain_text("this image is for an Arduino Nano", timeout=30_000)
    await_state(visited, "disabled")
    (tmp_path / "loop.hex").write_text(LOOP, encoding="ascii")
    file.set_input_files(tmp_path / "loop.hex")
    flash.click()
    expect(visited.get_by_text("The Arduino Mega 2560 holds what was written.")).to_be_visible(timeout=30_000)
    visited.reload()
    await_state(visited, "following")
