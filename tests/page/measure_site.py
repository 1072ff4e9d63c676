"""`python -m tests.page.measure_site`: what the page with a bench inside weighs and costs, as JSON; it judges nothing.

Times real time are of the bench alone, the motors on, a hand that swings and a sample each tick, in Node.js and in a
worker of the browser. The first motion counts from the page's address to motors that run. The tuning is in a worker
beside the bench's.
"""

from __future__ import annotations

import gzip
import json
import struct
import subprocess
import tempfile
import time
from pathlib import Path

from playwright.sync_api import Page

from greywhale.protocol import schema
from greywhale.protocol.frames import encode_frame
from tests.page import stage as stages
from tests.page.serve_folder import serve
from tools.setup import page
from tools.site.build import build

TICKS = 60_000
TUNED_BY_MS = 300_000
FRAMES = encode_frame(schema.TelemetryRequest.TYPE, 1, struct.pack("<H", 1)) + encode_frame(
    schema.EnableRequest.TYPE, 2, struct.pack("<H", 0)
)
SPEED = Path(__file__).with_name("bench_speed.js").read_text(encoding="utf-8")
IN_NODE = """const { readFileSync } = require("node:fs");
const { arm } = JSON.parse(readFileSync("bench.json", "utf8"));
const measure = SPEED
measure(readFileSync("bench.wasm"), arm, FRAMES, TICKS).then((speed) => console.log(speed));"""
IN_WORKER = """async () => {
  const [code, data] = await Promise.all([fetch("bench.wasm"), fetch("bench.json")])
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


def script(text: str) -> str:
    """With the function, frames and ticks in their places."""
    for name, value in (("SPEED", SPEED), ("FRAMES", str(list(FRAMES))), ("TICKS", str(TICKS))):
        text = text.replace(name, value)
    return text


def kilobytes(folder: Path) -> dict[str, float]:
    """kB of the files, compressed: the module, all before the arm is drawn, all of it, one file."""
    packed = {path.name: len(gzip.compress(path.read_bytes(), 9)) / 1000 for path in folder.iterdir()}
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
    visited.get_by_role("button", name="Controller").click()
    visited.get_by_role("button", name="Tune", exact=True).click()
    begun = time.monotonic()
    visited.get_by_text("Found; Apply runs it.").wait_for(timeout=TUNED_BY_MS)
    return time.monotonic() - begun


def measure(folder: Path) -> dict[str, float]:
    node = [str(page.node() / "bin" / "node"), "-e", script(IN_NODE)]
    in_node = float(subprocess.run(node, cwd=folder, capture_output=True, text=True, check=True).stdout)
    with serve(folder) as site, stages.browser() as browser:
        page_of_visitor = browser.new_page(viewport={"width": 1280, "height": 900})
        begun = time.monotonic()
        page_of_visitor.goto(site.page_address)
        page_of_visitor.wait_for_function("document.body.dataset.motors === 'on'")
        first_s = time.monotonic() - begun
        in_worker = float(page_of_visitor.evaluate(script(IN_WORKER)))
        tuned_s = tune(page_of_visitor)
    return {
        "times_real_time_in_node": round(in_node),
        "times_real_time_in_worker": round(in_worker),
        "first_motion_s": round(first_s, 2),
        "tuning_of_500_sets_s": round(tuned_s, 1),
    }


if __name__ == "__main__":
    with tempfile.TemporaryDirectory() as name:
        made = Path(name) / "site"
        build(made)
        print(json.dumps({**kilobytes(made), **measure(made)}))
