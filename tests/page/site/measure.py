"""`python -m tests.page.site.measure [MINUTES]`: what the page with a bench inside weighs and costs, as JSON lines.

Times real time are of the bench alone, the motors on, a hand that swings and a sample each tick, in Node.js and in a
worker of the browser. The first motion counts from the page's address to the first sample in which the follower has
moved. The tuning is in a worker beside the bench's. For so many minutes the page then runs at 1x: ticks that were due
and not made, samples that did not reach the page, memory. Nothing is judged.
"""

from __future__ import annotations

import gzip
import json
import struct
import subprocess
import sys
import tempfile
import time
from collections.abc import Iterator
from pathlib import Path

from playwright.sync_api import Page

from greywhale.protocol import schema
from greywhale.protocol.frames import FrameDecoder, encode_frame
from tests.page import stage as stages
from tests.page.measure import metric, samples_lost
from tests.page.measure_memory import MINUTE_MS, browser_megabytes
from tests.page.site.serve_folder import serve
from tools.setup import page
from tools.site.build import build

TICKS = 60_000
TUNED_BY_MS = 300_000
MOVED = 82  # counts of 1/4096 rad: 20 mrad, more than noise
FRAMES = encode_frame(schema.TelemetryRequest.TYPE, 1, struct.pack("<H", 1)) + encode_frame(
    schema.EnableRequest.TYPE, 2, struct.pack("<H", 0)
)
SPEED = Path(__file__).with_name("bench_speed.js").read_text(encoding="utf-8")
IN_NODE = """const { readFileSync } = require("node:fs");
const { arm } = JSON.parse(readFileSync("bench.json", "utf8"));
const measure = SPEED
measure(readFileSync("bench.wasm"), arm, FRAMES, TICKS).then((speed) => console.log(speed));"""
IN_WORKER = """async () => {
  const [code, data] = await Promise.all([fetch("FOLDER/bench.wasm"), fetch("FOLDER/bench.json")])
    .then(([module, bench]) => Promise.all([module.arrayBuffer(), bench.json()]));
  const source = `const measure = SPEED
    onmessage = async ({ data: [code, arm] }) => postMessage(await measure(code, arm, FRAMES, TICKS))`;
  const worker = new Worker(URL.createObjectURL(new Blob([source])));
  const speed = await new Promise((settle, fail) => {
    worker.onmessage = ({ data }) => settle(data);
    worker.onerror = ({ message }) => fail(new Error(message));
    worker.postMessage([code, data.arm]);
  });
  worker.terminate();
  return speed;
}"""

HEAR = """window.heard = [];
const Plain = Worker;
window.Worker = class extends Plain {
  constructor(...given) {
    super(...given);
    this.addEventListener("message", ({ data: { kind, data } }) => {
      if (kind === "bytes") heard.push([performance.now(), [...data]]);
    });
  }
};"""
# Of some pictures the one that is least behind: others show late what was made in time.
NOW = """async () => {
  const pictures = [];
  while (pictures.length < 30) {
    await new Promise(requestAnimationFrame);
    pictures.push([performance.now(), Number(document.querySelector(".live").dataset.tick)]);
  }
  return pictures.reduce((one, other) => (one[0] - one[1] < other[0] - other[1] ? one : other));
}"""


def script(text: str) -> str:
    """With the function, frames and ticks in their places."""
    for name, value in (("SPEED", SPEED), ("FRAMES", str(list(FRAMES))), ("TICKS", str(TICKS))):
        text = text.replace(name, value)
    return text


def kilobytes(folder: Path) -> dict[str, float]:
    """kB of the files, compressed: the module, all before the arm is drawn, all of it, one file."""
    files = (path for path in folder.rglob("*") if path.is_file())
    packed = {path.name: len(gzip.compress(path.read_bytes(), 9)) / 1000 for path in files}
    single = packed.pop("greywhale.html")
    modules = packed["bench.wasm"] + packed["tuner.wasm"]
    tuner = sum(packed.pop(f"tuner.{kind}") for kind in ("js", "json", "wasm"))  # comes when it is asked for
    scene = sum(size for name, size in packed.items() if name.startswith("scene"))
    return {
        "modules_kb_gzipped": round(modules, 1),
        "page_kb_gzipped": round(sum(packed.values()) - scene, 1),
        "page_and_arm_kb_gzipped": round(sum(packed.values()), 1),
        "tuner_kb_gzipped": round(tuner, 1),
        "single_file_kb_gzipped": round(single, 1),
    }


def tune(visited: Page) -> float:
    """Seconds from a click until all sets are tried; the bench goes on meanwhile."""
    visited.get_by_role("button", name="Controller", exact=True).click()
    visited.get_by_role("button", name="Tune", exact=True).click()
    begun = time.monotonic()
    visited.get_by_text("Found; Apply runs it.").wait_for(timeout=TUNED_BY_MS)
    return time.monotonic() - begun


def measure(folder: Path) -> dict[str, float]:
    node = [str(page.node() / "bin" / "node"), "-e", script(IN_NODE)]
    parts = next(path for path in folder.iterdir() if path.is_dir())
    in_node = float(subprocess.run(node, cwd=parts, capture_output=True, text=True, check=True).stdout)
    with serve(folder) as site, stages.browser() as browser:
        page_of_visitor = browser.new_page(viewport={"width": 1280, "height": 900})
        page_of_visitor.add_init_script(HEAR)
        page_of_visitor.goto(site.page_address)
        page_of_visitor.wait_for_function("heard.length > 500")
        first_s = first_motion_s(page_of_visitor.evaluate("heard.slice(0, 500)"))
        in_worker = float(page_of_visitor.evaluate(script(IN_WORKER).replace("FOLDER", parts.name)))
        tuned_s = tune(page_of_visitor)
    return {
        "times_real_time_in_node": round(in_node),
        "times_real_time_in_worker": round(in_worker),
        "first_motion_s": round(first_s, 2),
        "tuning_of_500_sets_s": round(tuned_s, 1),
    }


def first_motion_s(heard: list[tuple[float, list[int]]]) -> float:
    """When the follower had moved, of what the bench said at which time in ms."""
    decoder, start = FrameDecoder(), None
    for at_ms, data in heard:
        for frame in decoder.feed(bytes(data)):
            if frame.type != schema.Sample.TYPE:
                continue
            sample = schema.Sample.unpack(frame.payload)
            on = sample.state in (schema.State.SOFT_START, schema.State.FOLLOWING)
            start = start if on and start else sample.follower
            if on and max(abs(now - then) for now, then in zip(sample.follower, start, strict=True)) > MOVED:
                return at_ms / 1000
    raise AssertionError("the follower has not moved")


def run_long(folder: Path, minutes: int) -> Iterator[dict[str, float]]:
    """What each minute leaves behind."""
    with serve(folder) as site, stages.browser() as browser:
        visitor = browser.new_page(viewport={"width": 1280, "height": 900})
        visitor.goto(f"{site.page_address}#view=live")
        visitor.wait_for_selector(".live[data-tick]")
        session = visitor.context.new_cdp_session(visitor)
        session.send("Performance.enable")
        visitor.wait_for_timeout(MINUTE_MS / 12)
        begun_ms, first = visitor.evaluate(NOW)
        for minute in range(1, minutes + 1):
            visitor.wait_for_timeout(MINUTE_MS)
            session.send("HeapProfiler.collectGarbage")
            now_ms, tick = visitor.evaluate(NOW)
            yield {
                "minute": minute,
                "ticks": tick - first,
                "ticks_behind": round(now_ms - begun_ms - (tick - first)),
                "samples_lost": samples_lost(visitor),
                "browser_mb": round(browser_megabytes(browser), 1),
                "script_heap_mb": round(metric(session, "JSHeapUsedSize") / 1e6, 1),
            }


if __name__ == "__main__":
    with tempfile.TemporaryDirectory() as name:
        made = Path(name) / "site"
        build(made)
        print(json.dumps({**kilobytes(made), **measure(made)}), flush=True)
        for told in run_long(made, int(sys.argv[1]) if len(sys.argv) > 1 else 0):
            print(json.dumps(told), flush=True)
