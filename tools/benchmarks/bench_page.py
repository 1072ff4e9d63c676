"""Measures the bench inside a page, in a worker of Chromium: its speed, and whether a tick is ever late."""

from __future__ import annotations

import base64
from pathlib import Path
from typing import Any

from playwright.sync_api import sync_playwright

from greywhale.board.flash.images import read_pieces
from greywhale.files.arm import default_arm
from greywhale.protocol import frames, schema
from greywhale_sim.assemble import BUILDS
from greywhale_sim.bench import CLOCK_HZ, SLICES_PER_S
from greywhale_sim.wiring import MEGA
from tools.benchmarks.figure import Figure, at_least, at_most
from tools.setup import page_modules
from tools.site.bench_data import arm_numbers, wiring_numbers

CHROMIUM = "/usr/bin/chromium"
FOLLOWS_S = 600
WORKER = """
onmessage = async ({ data }) => {
  const refuse = () => { throw new Error("the module asked for a file"); };
  const bytes = (text) => Uint8Array.from(atob(text), (letter) => letter.charCodeAt(0));
  const { instance } = await WebAssembly.instantiate(bytes(data.code), {
    wasi_snapshot_preview1: { fd_close: refuse, fd_seek: refuse, fd_write: refuse },
  });
  const bench = instance.exports;
  bench._initialize();
  const fill = (text) => {
    const given = bytes(text);
    new Uint8Array(bench.memory.buffer, bench.bytes(), bench.bytes_size()).set(given);
    return given.length;
  };
  const live = (seconds) => {
    let said = [];
    for (let left = seconds * 1000; left > 0; left--) {
      const count = bench.run(4);
      if (left < 100) said.push(...new Uint8Array(bench.memory.buffer, bench.bytes(), count));
    }
    return said;
  };
  const numbers = () => new Float64Array(bench.memory.buffer, bench.numbers(), 256);  // the memory may grow
  numbers().set(data.numbers);
  bench.start(0);
  for (const [address, content, bootloader] of data.programs) bench.program(address, fill(content), bootloader);
  bench.power(1);
  live(1.5);
  for (const frame of data.frames) {
    bench.send(fill(frame));
    live(1.5);
  }
  const cycle = bench.cycle(), start = performance.now();
  for (let second = 0; second < data.seconds; second++) {  // the leader turns to and fro
    numbers().fill(0.3 * Math.sin(second), 0, 4);
    bench.lead();
    live(1);
  }
  const took = (performance.now() - start) / 1000;
  bench.send(fill(data.status));
  postMessage({ cycles: bench.cycle() - cycle, took, said: live(0.09) });
};
addEventListener("unhandledrejection", ({ reason }) => setTimeout(() => { throw reason; }));
"""
RUN = """([code, given]) => new Promise((settle, fail) => {
  const worker = new Worker(URL.createObjectURL(new Blob([code], { type: "text/javascript" })));
  worker.onmessage = ({ data }) => settle(data);
  worker.onerror = ({ message }) => fail(new Error(message));
  worker.postMessage(given);
})"""


def text(data: bytes) -> str:
    return base64.b64encode(data).decode("ascii")


def given() -> dict[str, Any]:
    firmware = BUILDS / MEGA.environment / "firmware.hex"
    asked = (schema.TelemetryRequest(1), schema.EnableRequest(0))
    return {
        "code": text(page_modules.BENCH.path.read_bytes()),
        "numbers": wiring_numbers(MEGA) + arm_numbers(default_arm()),
        "programs": [
            (address, text(content), int(path == MEGA.bootloader))
            for path in (MEGA.bootloader, Path(firmware))
            for address, content in read_pieces(path)
        ],
        "frames": [text(frames.encode_frame(one.TYPE, 1, one.pack())) for one in asked],
        "status": text(frames.encode_frame(schema.StatusRequest.TYPE, 2, b"")),
        "seconds": FOLLOWS_S,
    }


def run() -> list[Figure]:
    assert SLICES_PER_S == 4000
    with sync_playwright() as playwright:
        browser = playwright.chromium.launch(executable_path=CHROMIUM, args=["--no-sandbox"])
        page = browser.new_page()
        page.set_default_timeout(0)
        found = page.evaluate(RUN, [WORKER, given()])
        browser.close()
    replies = [
        schema.StatusReply.unpack(frame.payload)
        for frame in frames.FrameDecoder().feed(bytes(found["said"]))
        if frame.type == schema.StatusRequest.TYPE | schema.REPLY_BIT
    ]
    rate = found["cycles"] / found["took"]
    return [
        Figure("cycles in a worker of Chromium", rate / 1e6, "million/s"),
        at_least("the same, times real time", rate / CLOCK_HZ, "x", 3),
        at_most(f"late ticks in {FOLLOWS_S} s of following", replies[-1].late_ticks, "", 0),
    ]
