"""`python -m tests.page.measure`: what the page weighs and costs, as JSON; wants a quiet machine, and judges nothing.

A dashboard with its bench in real time, the motors on, all sixteen traces over ten seconds at each tick.
"""

from __future__ import annotations

import contextlib
import gzip
import json
import signal
import subprocess
import sys
import tempfile
import time
from collections.abc import Iterator

from playwright.sync_api import CDPSession, Page

from greywhale.dashboard.server import PAGE
from tests.page import stage as stages

MEASURED_MS = 10_000
COUNT_FRAMES = "window.drawn = 0; (function count() { window.drawn++; requestAnimationFrame(count); })()"


def sizes() -> dict[str, int]:
    """Bytes of the page, compressed, before and with the arm's view."""
    packed = {path.name: len(gzip.compress(path.read_bytes(), 9)) for path in PAGE.iterdir()}
    arm = sum(size for name, size in packed.items() if name.startswith("scene"))
    return {"page_gzipped": sum(packed.values()) - arm, "page_and_arm_gzipped": sum(packed.values())}


def metric(session: CDPSession, name: str) -> float:
    found = session.send("Performance.getMetrics")["metrics"]
    return float(next(one["value"] for one in found if one["name"] == name))


@contextlib.contextmanager
def dashboard() -> Iterator[tuple[int, str]]:
    """`greywhale dashboard --sim` in a folder of its own: its process, and the page's address."""
    with tempfile.TemporaryDirectory() as folder:
        words = ["dashboard", "--sim", "--no-browser", "--json", "--folder", folder]
        process = subprocess.Popen([sys.executable, "-m", "greywhale", *words], stdout=subprocess.PIPE, text=True)
        assert process.stdout is not None
        try:
            yield process.pid, json.loads(process.stdout.readline())["address"]
        finally:
            process.send_signal(signal.SIGINT)
            process.wait()


def open_live(page: Page, address: str) -> None:
    """Open the page and wait for its first picture."""
    page.goto(address)
    page.wait_for_function("() => document.querySelector('.live')?.dataset.tick > 0")


def samples_lost(page: Page) -> int:
    return int(page.locator("dt:text-is('samples lost') + dd").inner_text())


def measure() -> dict[str, float]:
    begun = time.monotonic()
    with dashboard() as (_, address), stages.browser() as browser:
        page = browser.new_context(viewport={"width": 1280, "height": 900}).new_page()
        open_live(page, address)
        first_s = time.monotonic() - begun
        page.locator("button.enable:enabled").click()
        page.wait_for_timeout(MEASURED_MS)
        session = page.context.new_cdp_session(page)
        session.send("Performance.enable")
        script_s = metric(session, "ScriptDuration")
        page.evaluate(COUNT_FRAMES)
        page.wait_for_timeout(MEASURED_MS)
        script_s = metric(session, "ScriptDuration") - script_s
        drawn = int(page.evaluate("window.drawn"))
        return {
            "script_ms_per_frame": round(1000 * script_s / drawn, 2),
            "frames_per_s": round(1000 * drawn / MEASURED_MS, 1),
            "first_picture_s": round(first_s, 2),
            "samples_lost": samples_lost(page),
            "heap_mb": round(metric(session, "JSHeapUsedSize") / 1e6, 1),
        }


if __name__ == "__main__":
    print(json.dumps({**sizes(), **measure()}))
