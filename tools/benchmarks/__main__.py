"""Runs the benchmarks: `python -m tools.benchmarks [name ...]`.

Each bench_<name>.py beside this file has run() -> list[Figure]. Prints a table and writes build/benchmarks.json. A
figure that misses its aim is shown as such but is no failure: how fast a machine is says nothing about whether the code
is right.
"""

from __future__ import annotations

import importlib
import json
import platform
import sys
from dataclasses import asdict
from datetime import UTC, datetime
from pathlib import Path

from tools import ROOT
from tools.benchmarks.figure import Figure

RESULT = ROOT / "build" / "benchmarks.json"
PREFIX = "bench_"


def names() -> list[str]:
    return sorted(path.stem.removeprefix(PREFIX) for path in Path(__file__).parent.glob(f"{PREFIX}*.py"))


def show(figure: Figure) -> None:
    verdict = {None: "", True: "ok", False: "MISSED"}[figure.holds]
    print(f"{figure.name:60} {figure.value:>12,.6g} {figure.unit:10} {figure.reach:24} {verdict}", flush=True)


def main(chosen: list[str]) -> int:
    unknown = sorted(set(chosen) - set(names()))
    if unknown:
        print(f"No benchmark is called {', '.join(unknown)}; there are {', '.join(names())}.", file=sys.stderr)
        return 2
    results: dict[str, list[dict[str, object]]] = {}
    for name in chosen or names():
        figures: list[Figure] = importlib.import_module(f"tools.benchmarks.{PREFIX}{name}").run()
        for figure in figures:
            show(figure)
        results[name] = [asdict(figure) for figure in figures]
    machine = f"{platform.machine()}, Python {platform.python_version()}"
    report = {"when": datetime.now(UTC).isoformat(timespec="seconds"), "machine": machine, "benchmarks": results}
    RESULT.write_text(json.dumps(report, indent=2) + "\n", encoding="utf-8")
    return 0


if __name__ == "__main__":
    sys.exit(main(sys.argv[1:]))
