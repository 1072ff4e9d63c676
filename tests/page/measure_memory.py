"""`python -m tests.page.measure_memory [MINUTES]`: memory of server and browser while the page runs, as JSON lines.

A dashboard with its bench in real time, 1 kHz, the motors on. The rings of ten minutes are filled by and by, so what
grows without end shows after the tenth minute; nothing is judged. Motors that a busy machine has stopped are started
again.
"""

from __future__ import annotations

import json
import sys
from pathlib import Path

from playwright.sync_api import Browser

from tests.page import stage as stages
from tests.page.measure import dashboard, metric, open_live, samples_lost

MINUTES = 13
MINUTE_MS = 60_000
TICKS_PER_S = 100  # of the time that a process has used, in /proc


def megabytes(process: int) -> float:
    """Memory of a process, its share of what it shares with others."""
    rows = Path(f"/proc/{process}/smaps_rollup").read_text().splitlines()
    return int(next(row for row in rows if row.startswith("Pss:")).split()[1]) / 1024


def used_s(process: int) -> float:
    """Time that a process has computed."""
    words = Path(f"/proc/{process}/stat").read_text().rpartition(")")[2].split()
    return (int(words[11]) + int(words[12])) / TICKS_PER_S


def browser_megabytes(browser: Browser) -> float:
    """Memory of the browser with all its processes."""
    told = browser.new_browser_cdp_session().send("SystemInfo.getProcessInfo")
    return sum(megabytes(one["id"]) for one in told["processInfo"])


def measure(minutes: int) -> None:
    with dashboard() as (server, address), stages.browser() as browser:
        page = browser.new_context(viewport={"width": 1280, "height": 900}).new_page()
        open_live(page, address)
        session = page.context.new_cdp_session(page)
        session.send("Performance.enable")
        before_s = used_s(server)
        for minute in range(minutes + 1):
            session.send("HeapProfiler.collectGarbage")
            now_s = used_s(server)
            told = {
                "minute": minute,
                "server_mb": round(megabytes(server), 1),
                "server_of_a_core": round((now_s - before_s) / (MINUTE_MS / 1000), 3),
                "browser_mb": round(browser_megabytes(browser), 1),
                "script_heap_mb": round(metric(session, "JSHeapUsedSize") / 1e6, 1),
                "samples_lost": samples_lost(page),
                "state": page.locator(".pill").inner_text(),
            }
            print(json.dumps(told), flush=True)
            before_s = now_s
            for enable in page.locator("button.enable:enabled").all():
                enable.click()
            if minute < minutes:
                page.wait_for_timeout(MINUTE_MS)


if __name__ == "__main__":
    measure(int(sys.argv[1]) if len(sys.argv) > 1 else MINUTES)
