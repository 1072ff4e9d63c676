"""The page with a bench inside, as a folder or one file: what a first visitor sees and does, with no other network."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass
from pathlib import Path

import pytest
from playwright.sync_api import BrowserContext, Page, expect

from greywhale.files.log import read_log
from tests.page import stage as stages
from tests.page.barriers import DARK_AND_NARROW, require_no_barrier
from tests.page.drag import drag, value_of
from tests.page.serve_folder import Site, serve
from tools.site.build import build

pytestmark = pytest.mark.slow

STOP_AT_ONCE = """new MutationObserver((_, watch) => {
  const stop = document.querySelector("button.stop");
  if (!stop) return;
  watch.disconnect();
  stop.click();
}).observe(document, { childList: true, subtree: true })"""
KEPT, ASIDE = "greywhale-eeprom", "greywhale-eeprom-damaged"


@dataclass(frozen=True)
class OnDisk:
    """The page as one file, which no server hands out."""

    page_address: str
    port: int = 0


@pytest.fixture(scope="module")
def folder(tmp_path_factory: pytest.TempPathFactory) -> Path:
    made: Path = tmp_path_factory.mktemp("site")
    build(made)
    return made


@pytest.fixture
def site(folder: Path) -> Iterator[Site]:
    with serve(folder) as served:
        yield served


@pytest.fixture
def visited(context: BrowserContext, site: Site) -> Iterator[Page]:
    """A page that somebody opens for the first time."""
    with stages.visit(context, site) as visit:
        yield visit.page


def test_a_visitor_sees_an_arm_that_follows_and_what_needs_a_host_is_not_there(visited: Page) -> None:
    expect(visited.locator("nav button")).to_have_text(["Arm", "Live", "Controller", "Bench"])
    expect(visited.get_by_text("no cycle timing")).to_be_visible()
    expect(visited.locator(".pill")).to_have_text("following")
    visited.get_by_role("button", name="Live").click()
    visited.wait_for_function(
        """() => [...document.querySelectorAll(".values tbody tr")].some((row) => {
          const [leader, follower] = [...row.querySelectorAll("td")].slice(-4).map((cell) => Number(cell.innerText));
          return Math.abs(leader) > 0.3 && Math.abs(leader - follower) < 0.1;
        })"""
    )
    visited.get_by_role("button", name="Controller").click()
    expect(visited.get_by_text("Control surface")).to_be_visible()
    expect(visited.get_by_text("The model predicts")).to_have_count(0)
    expect(visited.get_by_text("Against a file")).to_have_count(0)
    visited.get_by_role("button", name="Bench").click()
    expect(visited.get_by_role("button", name="Hold still")).to_be_visible()
    expect(visited.get_by_label("Recorded motion")).to_have_count(0)
    visited.keyboard.press("Space")
    expect(visited.locator(".pill")).to_have_text("disabled")


def test_who_stops_before_the_arm_has_moved_is_obeyed(context: BrowserContext, site: Site, tmp_path: Path) -> None:
    with stages.visit(context, site, STOP_AT_ONCE) as visit:
        visit.page.get_by_role("button", name="Live").click()
        visit.page.wait_for_function("document.querySelector('.live')?.dataset.tick > 600")
        with visit.page.expect_download() as saved:
            visit.page.get_by_role("button", name="Save view").click()
        saved.value.save_as(tmp_path / "view.csv")
    assert set(read_log(tmp_path / "view.csv").state) == {"disabled"}


def tune_a_little(page: Page) -> None:
    """Let the page tune, and end that as soon as it can be."""
    page.get_by_role("button", name="Controller").click()
    page.get_by_role("button", name="Tune", exact=True).click()
    expect(page.get_by_text("of 500 sets")).to_be_visible()
    page.get_by_role("button", name="Stop the search").click()
    expect(page.get_by_text("Found; Apply runs it.")).to_be_visible()


def test_who_lets_the_page_tune_sees_the_course_and_runs_what_was_found(visited: Page) -> None:
    expect(visited.locator(".pill")).to_have_text("following")
    visited.get_by_role("button", name="Controller").click()
    drag(visited, "Pe_b", 0.1)
    tune_a_little(visited)
    expect(visited.get_by_label("Curve of the search")).to_be_visible()
    expect(visited.get_by_label("The same hand, followed before and after")).to_be_visible()
    visited.get_by_role("button", name="Apply").click()
    expect(visited.get_by_text("The board runs these controllers.")).to_be_visible()
    expect(visited.locator(".pill")).to_have_text("following")
    require_no_barrier(visited, DARK_AND_NARROW)


def test_one_file_alone_opens_from_a_disk_and_tunes(context: BrowserContext, folder: Path, tmp_path: Path) -> None:
    alone = (folder / "greywhale.html").rename(tmp_path / "alone.html")
    with stages.visit(context, OnDisk(alone.as_uri())) as visit:
        expect(visit.page.locator(".pill")).to_have_text("following")
        visit.page.locator("canvas").first.wait_for()
        tune_a_little(visit.page)


def test_a_wire_is_broken_and_mended(visited: Page) -> None:
    expect(visited.locator(".pill")).to_have_text("following")
    visited.get_by_role("button", name="Bench").click()
    visited.get_by_role("button", name="Hold still").click()
    visited.get_by_label("Speed of time, ×").fill("10")
    visited.get_by_label("Speed of time, ×").dispatch_event("change")
    visited.get_by_label("Fault").select_option("pot-open")
    visited.get_by_label("Where").select_option("follower1")
    visited.get_by_role("button", name="Break", exact=True).click()
    expect(visited.locator(".pill")).to_have_text("fault")
    visited.get_by_role("button", name="Mend all").click()
    expect(visited.locator(".differences li")).to_have_count(0)
    visited.get_by_role("button", name="Live").click()
    fault = visited.get_by_role("alert").filter(has_text="follower potentiometer 1")
    fault.get_by_role("button", name="Clear fault").click()
    expect(visited.locator(".pill")).to_have_text("disabled")
    visited.get_by_role("button", name="Enable").click()
    expect(visited.locator(".pill")).to_have_text("following")


def test_what_is_stored_is_there_after_a_reload_unless_it_is_damaged(visited: Page) -> None:
    expect(visited.locator(".pill")).to_have_text("following")
    visited.get_by_role("button", name="Stop").click()
    visited.get_by_role("button", name="Controller").click()
    drag(visited, "Pe_b", 0.1)
    dragged = value_of(visited, "Pe_b")
    visited.get_by_role("button", name="Apply").click()
    expect(visited.get_by_text("The board runs these controllers.")).to_be_visible()
    visited.get_by_role("button", name="Store").click()
    expect(visited.get_by_text("The board has stored these controllers.")).to_be_visible()
    visited.reload()
    visited.get_by_role("button", name="Controller").click()
    visited.get_by_role("slider", name="Pe_b", exact=True).wait_for()
    assert value_of(visited, "Pe_b") == pytest.approx(dragged, abs=1e-4)
    expect(visited.get_by_text("The board has stored these controllers.")).to_be_visible()
    visited.evaluate("([key, text]) => localStorage.setItem(key, text)", [KEPT, "no memory"])
    visited.reload()
    expect(visited.locator(".notice")).to_contain_text("is damaged; it is set aside")
    assert visited.evaluate("(key) => localStorage.getItem(key)", ASIDE) == "no memory"
