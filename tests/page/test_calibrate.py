"""A new board on a bench that is wired wrongly, calibrated by the page alone: its hands, and a person who errs."""

from __future__ import annotations

from collections.abc import Iterator
from itertools import pairwise

import pytest
from playwright.sync_api import Page, expect

from greywhale.board.calibrate.motors import LEASE_MS
from greywhale.board.pots import POTS
from greywhale.protocol.schema import DEFAULTS, PARAMETER_BY_NAME, Sample, State
from tests.page.barriers import DARK_AND_NARROW, require_no_barrier
from tests.page.stage import Stage, await_state

pytestmark = pytest.mark.slow

HANDS = "Let the bench's hands do it"
POSE = [0.6, 0.3, -0.4, 0.5]
BROUGHT_S = 1.5  # after which hands have brought both arms to a pose
NEAR_RAD = 0.06  # of a follower that keeps up with its leader

# Within the page, so that a slow test cannot be late: Stop is pressed as soon as this text is there.
STOP_AT = """
  text => {
    const view = document.querySelector(".calibrate");
    const stop = [...document.querySelectorAll("button")].find(({ textContent }) => textContent === "Stop");
    new MutationObserver((_, watch) => {
      if (!view.textContent.includes(text)) return;
      watch.disconnect();
      stop.click();
    }).observe(view, { childList: true, characterData: true, subtree: true });
  }
"""


@pytest.fixture(scope="module")
def stage(tmp_path_factory: pytest.TempPathFactory) -> Iterator[Stage]:
    wired = ("--mistake", "pot-reversed:leader1", "--mistake", "motor-reversed:1")
    made = Stage(tmp_path_factory.mktemp("folder"), *wired)
    with made.open():
        yield made


def press(page: Page, name: str) -> None:
    """By the keyboard, which need not wait until nothing moves on the page."""
    button = page.get_by_role("button", name=name, exact=True)
    expect(button).to_be_enabled()
    button.press("Enter")


def live_until(page: Page, stage: Stage, text: str) -> None:
    """Let the board live until the page shows this.

    It goes on once the page has drawn: on a quick machine it would live for minutes meanwhile.
    """
    shown = page.locator(".calibrate").get_by_text(text)
    while not shown.count():
        stage.live(0.5)
        page.evaluate("() => new Promise(requestAnimationFrame)")


def refuse_a_pose_that_is_not_held(page: Page, stage: Stage) -> None:
    """A joint of the leader turns for longer than any page needs to look at it."""
    stage.command("turn leader 0 20")
    stage.live(1.0)
    press(page, "Take the pose")
    live_until(page, stage, "hold both arms still.")
    stage.command("hold 0")
    stage.live(BROUGHT_S)


def pulses(samples: list[Sample]) -> list[int]:
    """How many ticks the motors were on, each time."""
    on = [0, *(sample.state in (State.SOFT_START, State.FOLLOWING) for sample in samples), 0]
    changes = [at for at, (one, other) in enumerate(pairwise(on)) if one != other]
    return [end - begin for begin, end in zip(changes[::2], changes[1::2], strict=True)]


def test_a_new_board_is_calibrated_by_the_page_and_follows(page: Page, stage: Stage) -> None:
    press(page, "Calibrate")
    press(page, "Begin")
    press(page, "Let them turn a wrong joint")
    live_until(page, stage, "and did not move, but leader potentiometer 1 did")
    for number in range(8):
        live_until(page, stage, f"Sweep {number + 1} of 8")
        if number > 1:
            expect(page.get_by_role("button", name=HANDS)).to_be_focused()
        press(page, HANDS)
    for number in range(4):
        live_until(page, stage, f"Pose {number + 1} of 4")
        if number == 1:
            refuse_a_pose_that_is_not_held(page, stage)
        press(page, HANDS)
    live_until(page, stage, "if the motors' supply has not")
    page.evaluate(STOP_AT, "Motor 3 of 4, joint 2, wrist pitch, gets pulses.")
    press(page, "Let the bench's hands let it hang")
    live_until(page, stage, "turned the wrong way, motor_sign is changed")
    tried = pulses(stage.samples())
    assert len(tried) >= 8
    assert max(tried) <= LEASE_MS
    press(page, "Leave the motors as they are")
    live_until(page, stage, "as the joint → reversed")
    assert stage.command("status")["eeprom_writes"] == 0, "nothing is stored unasked"
    press(page, "Yes, store it")
    live_until(page, stage, "An arm file needs these potentiometers too")
    require_no_barrier(page, DARK_AND_NARROW, views="Calibrate")
    changed = {f"{pot}.{key}": key for pot in POTS for key in ("zero", "scale")} | {"joint1.motor_sign": "motor_sign"}
    names = [name for name in PARAMETER_BY_NAME if name in changed or ("limit_" in name and name.startswith("joint"))]
    found = stage.runs(*(PARAMETER_BY_NAME[name] for name in names))
    for name, key in changed.items():
        was = DEFAULTS[PARAMETER_BY_NAME[name].index] * (-1 if name in ("leader1.scale", "joint1.motor_sign") else 1)
        assert found[name] == pytest.approx(was, rel=0.01), (name, key)

    press(page, "Enable")
    await_state(page, "following")
    stage.command(f"lead {' '.join(map(str, POSE))}")

    def arrived() -> bool:
        newest = stage.newest()
        wanted = [4096 * angle for angle in POSE]
        arms = (newest.leader, newest.follower)
        return all(abs(is_ - at) < 4096 * NEAR_RAD for arm in arms for is_, at in zip(arm, wanted, strict=True))

    stage.wait_for(arrived)
    press(page, "Stop")
    await_state(page, "disabled")
    press(page, "Undo")
    live_until(page, stage, "The parameters from before run and are stored again.")
    stage.runs()
    expect(page.get_by_role("button", name="Undo")).to_have_count(0)

    page.locator("summary", has_text="Earlier calibrations (3)").press("Enter")
    kept = page.locator(".earlier li")
    expect(kept.nth(0)).to_contain_text("(the newest)")
    expect(kept.nth(1)).to_contain_text("joint 1 (shoulder pitch): the leader reads the other way")
    press(page, "Go back to calibration 2")
    live_until(page, stage, "The board runs and keeps calibration 2 again.")
    again = stage.runs(*(PARAMETER_BY_NAME[name] for name in names))
    assert again == found
