"""A real board from the page: its serial port is false, and leads to the simulated board with its real bootloader."""

from __future__ import annotations

import math
import re
from pathlib import Path

import pytest
from playwright.sync_api import BrowserContext, Page, expect

from greywhale.base.errors import UserError
from greywhale.board.calibrate.motors import LEASE_MS
from greywhale.board.calibrate.rules import MARGIN_RAD, PULSE_SHARES
from greywhale.board.device import Device
from greywhale.board.flash.images import read_image
from greywhale.board.pots import POTS
from greywhale.board.upload import read_parameters
from greywhale.files import controller, parameter_file
from greywhale.files.arm import content_of
from greywhale.files.log import read_log
from greywhale.files.paper_tables import paper_table
from greywhale.protocol.table import ParameterTable
from greywhale_sim.lockstep import LockStepBench
from greywhale_sim.person_commands import ENDS_DEG
from greywhale_sim.words import lock_step
from tests.board.flash import newer_nano
from tests.board.flash.hex_files import hex_text
from tests.files.older_parameters import write_older
from tests.page.barriers import DARK_AND_NARROW, require_no_barrier
from tests.page.site.false_serial import Sent, connected
from tests.page.site.serve_folder import Site

pytestmark = pytest.mark.slow

HIDE = 'Object.defineProperty(document, "visibilityState", { get: () => "hidden", configurable: true })'
WATCH_REQUESTS = """() => {
  const ask = fetch;
  portOpenAtRequest = [];
  fetch = (file) => {
    if (String(file).endsWith(".hex")) portOpenAtRequest.push(navigator.serial.granted[0].readable !== null);
    return ask(file);
  };
}"""
DEFAULTS = ParameterTable.defaults()
USED_POTS = (0, 1, 4, 5)  # the others cost time alone, so their joints are not in use
UNUSED = {f"{pot}.scale": 0 for number, pot in enumerate(POTS) if number not in USED_POTS}
SHOW = "delete document.visibilityState"


def press(page: Page, *names: str) -> None:
    for name in names:
        page.get_by_role("button", name=name, exact=True).click()


def hold(page: Page, bench: LockStepBench, angle: float) -> None:
    """Bring both arms into a pose, every joint at an angle, and hold them there for a while of the board's time."""
    bench.command(f"hand both {angle} {angle} {angle} {angle} 0.3")
    live(page, bench, 0.8)


def sweep(page: Page, bench: LockStepBench, pot: int) -> None:
    """Turn a joint to both ends, and say that it is done; the page asks for it."""
    side = ("leader", "follower")[pot // 4]
    expect(page.locator("h3").first).to_contain_text(f": {side.capitalize()} joint {pot % 4}, ")
    live(page, bench, bench.command(f"turn {side} {pot % 4} 0.1")["arrives_s"] - bench.bench.time_s)
    press(page, "Done")


def wire(page: Page, bench: LockStepBench, mistake: str) -> None:
    """Wire the arm so, and let the page take in all samples from before."""
    bench.command(f"mistake {mistake}")
    live(page, bench, 0.1)


def live(page: Page, bench: LockStepBench, seconds: float) -> None:
    """Let so much of the board's time pass, in which the page is served."""
    until_s = bench.bench.time_s + seconds
    while bench.bench.time_s < until_s:
        page.wait_for_timeout(20)


def require_a_prediction_for_an_arm_of_ones_own(page: Page, folder: Path) -> None:
    """Before there is one it is the default arm's, and says so."""
    press(page, "Controller")
    expect(page.get_by_text("This is greywhale's default arm, not yours.")).to_be_visible()
    predicted = page.locator(".predict[data-rms]")
    others = predicted.get_attribute("data-rms")
    arm, wrong = folder / "arm.toml", folder / "wrong_arm.toml"
    arm.write_bytes(content_of("worn"))
    wrong.write_bytes(content_of("worn").replace(b"gravity = ", b"gravitas = "))
    page.get_by_label("An arm.toml or model.toml of yours").set_input_files(wrong)
    expect(page.get_by_text("wrong_arm.toml: unknown key gravitas; perhaps gravity is meant.")).to_be_visible()
    page.get_by_label("An arm.toml or model.toml of yours").set_input_files(arm)
    expect(page.get_by_text("arm.toml is the arm as it is described there.")).to_be_visible()
    expect(page.locator(f".predict[data-rms]:not([data-rms='{others}'])")).to_be_visible()
    press(page, "Tune")
    expect(page.get_by_text("This page tunes for the default arm alone")).to_be_visible()


def test_a_board_is_watched_driven_and_changed(context: BrowserContext, site: Site, tmp_path: Path) -> None:
    with lock_step() as bench, connected(context, site, bench) as (page, cable):
        pill = page.locator(".pill")
        expect(page.get_by_role("main")).to_contain_text("No board is connected.")
        press(page, "Connect")
        expect(pill).to_have_text("disabled")
        assert cable.restarts == 0
        press(page, "Live", "Record", "Enable")
        expect(pill).to_have_text("following")
        live(page, bench, 0.5)  # longer than a lease
        expect(pill).to_have_text("following")
        page.evaluate(HIDE)
        expect(pill).to_have_text("disabled")
        expect(page.get_by_text("the lease ran out without being renewed")).to_be_visible()
        page.evaluate(SHOW)
        press(page, "Enable")
        expect(pill).to_have_text("following")
        with page.expect_download() as saved:
            press(page, "Stop", "End recording")
        saved.value.save_as(tmp_path / "recording.csv")
        assert {"soft_start", "following"} <= set(read_log(tmp_path / "recording.csv").state)
        page.get_by_label("Task").fill("Wave")
        page.get_by_role("main").focus()
        page.keyboard.press("r")
        live(page, bench, 0.1)
        with page.expect_download() as saved:
            page.keyboard.press("r")
        assert saved.value.suggested_filename == "episode_000.csv"
        saved.value.save_as(tmp_path / "episode.csv")
        assert read_log(tmp_path / "episode.csv").origin.task == "Wave"
        theirs = "episode_000.csv is among your browser's downloads; delete it there."
        expect(page.get_by_role("button", name="Discard")).to_have_attribute("title", theirs)

        wanted = tmp_path / "controller.toml"
        wanted.write_text(paper_table("table_10").read_text("utf-8"))
        wrong = tmp_path / "wrong.toml"
        wrong.write_text(wanted.read_text("utf-8").replace("kp = ", "kp = 9", 1))
        press(page, "Parameters")
        page.get_by_label("tracking_ms").fill("300")
        page.get_by_label("tracking_ms").press("Tab")
        press(page, "Apply")
        expect(page.get_by_role("button", name="Apply")).to_be_disabled()
        backup = tmp_path / "backup.toml"
        parameter_file.save(backup, DEFAULTS.with_raw({"supply_mv": 12_000} | UNUSED))
        older = tmp_path / "older.toml"
        write_older(older, DEFAULTS.with_raw(UNUSED), 1)
        page.get_by_label("Restore a parameter file").set_input_files(older)
        expect(page.get_by_text("It is older and does not state")).to_be_visible()
        page.get_by_label("Restore a parameter file").set_input_files(backup)
        changes = page.get_by_role("list", name="Changes").get_by_role("listitem")
        expect(changes).to_have_count(2 + len(UNUSED))
        expect(changes).to_contain_text(["supply_mv15000 → 12000 mV", "tracking_ms300 → 200 ms"])
        press(page, "Apply")
        expect(page.get_by_text("The changes run; Store keeps them.")).to_be_visible()
        press(page, "Store")
        expect(page.get_by_text("What runs is stored.")).to_be_visible()
        press(page, "Start")
        done, not_yet, unknown = "done", "not yet", "not known here"
        marks = [done, done, done, unknown, not_yet, done, unknown, not_yet]
        expect(page.locator(".way-mark")).to_have_text(marks)
        expect(page.get_by_text("It needs greywhale on this computer: `greywhale doctor`.")).to_be_visible()
        require_a_prediction_for_an_arm_of_ones_own(page, tmp_path)
        press(page, "Parameters")
        page.get_by_label("Upload a controller.toml").set_input_files(wrong)
        with pytest.raises(UserError) as refused:
            controller.load(wrong)
        expect(page.get_by_role("alert")).to_have_text(refused.value.message.replace(str(wrong), wrong.name) + "×")
        page.get_by_label("Upload a controller.toml").set_input_files(wanted)
        expect(page.get_by_text("controller.toml runs and is stored")).to_be_visible()

        press(page, "Calibrate")
        wire(page, bench, "pot-swapped:leader0")
        press(page, "Begin")
        expect(page.get_by_role("button", name="first pose", exact=True)).to_be_disabled()
        expect(page.get_by_role("button", name="first pose", exact=True)).to_have_attribute(
            "title", "First comes: sweep of leader joint 0."
        )
        sweep(page, bench, 0)
        expect(page.get_by_text("leader potentiometer 1 did: their wires are swapped")).to_be_visible()
        wire(page, bench, "none")
        press(page, "Again")
        for number in USED_POTS:
            sweep(page, bench, number)
        for pose, angle in (("first pose", 0.0), ("second pose", 1.0), ("first pose again", 0.0), ("third pose", -0.5)):
            expect(page.locator("h3").first).to_contain_text(f": {pose}")
            for field in page.get_by_label(re.compile("^Joint ., degrees")).all():
                field.fill(f"{math.degrees(angle):.4f}")
            hold(page, bench, angle)
            press(page, "Take the pose")
        expect(page.locator("h3").first).to_have_text("Motors")
        bench.command("motor 1 reversed")
        live(page, bench, bench.command("hang")["arrives_s"] - bench.bench.time_s)
        press(page, "Try the motors")
        page.get_by_role("alertdialog").get_by_role("button", name="Stop").click()
        expect(page.get_by_text("The motors were not tried: Stop was pressed")).to_be_visible()
        press(page, "Try the motors")
        expect(page.get_by_text("Motor 1 of 2, joint 0, base yaw, gets pulses.")).to_be_visible()
        page.evaluate(HIDE)
        expect(page.get_by_text("The motor of joint 0 was not tried to the end")).to_be_visible()
        page.evaluate(SHOW)
        bench.command("pins")
        press(page, "Try the motors")
        expect(page.get_by_text("turned the wrong way, motor_sign is changed")).to_be_visible()
        seen = bench.command("pins")
        assert 0.0 < max(seen["duties"]) <= PULSE_SHARES[-1] + 1 / 400
        assert seen["longest_on_s"] <= LEASE_MS / 1000 + 0.002
        press(page, "Go on", "Yes, store it")
        expect(page.get_by_text("An arm file needs these potentiometers too")).to_be_visible()
        require_no_barrier(page, DARK_AND_NARROW, views="Port|Calibrate")  # the others are the site's too

        press(page, "Parameters")
        with page.expect_download() as saved:
            press(page, "Save to a file")
        saved.value.save_as(tmp_path / "parameters.toml")

        cable.plugged = False
        press(page, "Port")
        expect(page.get_by_role("main")).to_contain_text("The board was unplugged")
        cable.plugged = cable.opening_restarts = True
        page.evaluate("navigator.serial.plugIn()")
        expect(page.get_by_role("alert")).to_contain_text("Opening the port has restarted the board.")
        expect(pill).to_have_text("disabled")
        press(page, "Restart and connect")
        expect(page.get_by_role("main")).to_contain_text("USB 2341:0042 is connected.")
        assert cable.restarts == 1
        press(page, "Disconnect")
        expect(page.get_by_role("button", name="Connect", exact=True)).to_be_enabled()
        with Device(bench.port) as device:
            stored = read_parameters(device)
        assert stored == parameter_file.load(tmp_path / "parameters.toml")
        assert stored.controllers == controller.load(wanted).table().controllers
        for pot in (POTS[number] for number in USED_POTS):  # as the default arm's are mounted
            assert stored[f"{pot}.zero"] == pytest.approx(DEFAULTS[f"{pot}.zero"], abs=40)
            assert stored[f"{pot}.scale"] == pytest.approx(DEFAULTS[f"{pot}.scale"], rel=0.01)
        assert stored.each("joint", "motor_sign") == (1, -1, 1, 1)
        highest = 4096 * (math.radians(ENDS_DEG[0]) - MARGIN_RAD)
        assert stored.each("joint", "limit_max")[:2] == pytest.approx([highest] * 2, abs=60)


def flash_a_board_of_another_program(
    context: BrowserContext, site: Site, folder: Path, tmp_path: Path, board: str, other: str, title: str
) -> list[Sent]:
    """Refuse the other board's image, break a flash off, and flash; what the page has sent."""
    (parts,) = (path for path in folder.iterdir() if path.is_dir())
    image = read_image(parts / f"{board}.hex").memory
    before = tmp_path / "before.hex"
    before.write_text(hex_text(bytes(len(image))))  # what was not erased stays zero
    words = ("--board", board, "--firmware", str(before))
    with lock_step(*words) as bench, connected(context, site, bench) as (page, cable):
        page.evaluate(WATCH_REQUESTS)
        page.get_by_label("A HEX file in its place").set_input_files(parts / f"{other}.hex")
        press(page, "Flash")
        expect(page.get_by_role("alert")).to_contain_text(f"but the board on this port is an Arduino {title}; choose")
        assert bench.server.board.flash()[: len(image)] == bytes(len(image))
        page.get_by_label("A HEX file in its place").set_input_files([])
        press(page, "Flash")
        expect(page.get_by_role("main")).to_contain_text("Flashwriting")
        cable.plugged = False
        expect(page.get_by_role("alert")).to_contain_text("The bootloader stopped answering while writing")
        assert bench.server.board.flash()[:2] == b"\xff\xcf", "a loop, where half of a program would do anything"
        cable.plugged = True
        page.evaluate("navigator.serial.plugIn()")
        press(page, "Flash")
        expect(page.get_by_role("main")).to_contain_text(f"The Arduino {title} holds what was written; firmware")
        expect(page.locator(".pill")).to_have_text("disabled")
        assert bench.server.board.flash()[: len(image)] == image
        assert page.evaluate("portOpenAtRequest") == 2 * [False, False]  # a bootloader does not wait for a slow network
        return cable.sent


def test_a_mega_is_flashed_and_a_nanos_image_refused(
    context: BrowserContext, site: Site, folder: Path, tmp_path: Path
) -> None:
    flash_a_board_of_another_program(context, site, folder, tmp_path, "mega", "nano", "Mega 2560")


NANO = ("nano", "mega", "Nano (ATmega328P)")
FLASHES_S = 0.375  # of optiboot's LED


def asked_as_optiboot(sent: list[Sent]) -> list[float]:
    """When the page asked whether optiboot is there."""
    return [one.at_s for one in sent if (one.baud, one.text) == (newer_nano.BAUD, "0 ")]


def test_an_older_nano_is_flashed_and_a_megas_image_refused(
    context: BrowserContext, site: Site, folder: Path, tmp_path: Path
) -> None:
    """It is silent at the newer Nano's speed, so each of three times the page asks there twice."""
    asked = asked_as_optiboot(flash_a_board_of_another_program(context, site, folder, tmp_path, *NANO))
    assert len(asked) == 6
    assert all(second - first > FLASHES_S for first, second in zip(asked[::2], asked[1::2], strict=True))


def test_a_newer_nano_is_flashed_and_asked_once_while_its_led_flashes(
    context: BrowserContext, site: Site, folder: Path, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    """Each of four times that it starts: three times to be found, and once for its first page."""
    newer_nano.fit_optiboot(tmp_path, monkeypatch)
    assert len(asked_as_optiboot(flash_a_board_of_another_program(context, site, folder, tmp_path, *NANO))) == 4
