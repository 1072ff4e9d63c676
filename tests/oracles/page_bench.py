"""The module with which a page simulates a bench, run by Node.js: its calls, one by one or many at once."""

from __future__ import annotations

import json
import subprocess
from collections.abc import Sequence
from pathlib import Path
from typing import Any

from greywhale.arm import ArmParameters
from greywhale.base.closing import Closing
from tools.setup import page, page_modules
from tools.site.bench_data import arm_numbers

HARNESS = Path(__file__).with_name("wasm") / "bench.mjs"
TICK_SLICES = 4


class PageBench(Closing):
    """A context: a bench with this arm, its power off."""

    def __init__(self, arm: ArmParameters, seed: int = 1) -> None:
        command = [str(page.node() / "bin" / "node"), str(HARNESS), str(page_modules.BENCH.path)]
        self._node = subprocess.Popen(command, stdin=subprocess.PIPE, stdout=subprocess.PIPE, text=True)
        self.call("put", arm_numbers(arm))
        self.call("start", seed)

    def close(self) -> None:
        assert self._node.stdin is not None
        self._node.stdin.close()
        self._node.wait()

    def call(self, name: str, *given: Any) -> Any:
        return self.calls([[name, *given]])[0]

    def calls(self, calls: Sequence[Sequence[Any]]) -> list[Any]:
        """Few enough that their answers fit into a pipe."""
        assert self._node.stdin is not None
        assert self._node.stdout is not None
        self._node.stdin.write("".join(json.dumps(call) + "\n" for call in calls))
        self._node.stdin.flush()
        return [json.loads(self._node.stdout.readline()) for _ in calls]
