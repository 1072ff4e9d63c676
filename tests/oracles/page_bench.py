"""The module with which a page simulates a bench, run by Node.js."""

from __future__ import annotations

import json
import subprocess
from pathlib import Path
from typing import Any

from greywhale.arm import ArmParameters
from greywhale.base.closing import Closing
from greywhale.board.flash.images import read_pieces
from greywhale_sim.wiring import BOARDS, Wiring
from tools.setup import page, page_modules
from tools.site.bench_data import arm_numbers, wiring_numbers

HARNESS = Path(__file__).with_name("wasm") / "bench.mjs"


class PageBench(Closing):
    """A context: a bench with this arm, its board with bootloader and firmware, its power off."""

    def __init__(self, arm: ArmParameters, wiring: Wiring, firmware: Path) -> None:
        command = [str(page.node() / "bin" / "node"), str(HARNESS), str(page_modules.BENCH.path)]
        self._node = subprocess.Popen(command, stdin=subprocess.PIPE, stdout=subprocess.PIPE, text=True)
        self.call("put", wiring_numbers(wiring) + arm_numbers(arm))
        self.call("start", list(BOARDS.values()).index(wiring))
        for path in (wiring.bootloader, firmware):
            for address, content in read_pieces(path):
                self.call("fill", content.hex())
                self.call("program", address, len(content), int(path == wiring.bootloader))

    def close(self) -> None:
        assert self._node.stdin is not None
        self._node.stdin.close()
        self._node.wait()

    def call(self, name: str, *given: Any) -> Any:
        assert self._node.stdin is not None
        assert self._node.stdout is not None
        self._node.stdin.write(json.dumps([name, *given]) + "\n")
        self._node.stdin.flush()
        return json.loads(self._node.stdout.readline())

    def send(self, data: bytes) -> None:
        self.call("fill", data.hex())
        self.call("send", len(data))
