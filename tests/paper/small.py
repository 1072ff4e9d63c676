"""The whole of the report's work at its smallest, for tests: some seconds of one core."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace
from functools import cache
from inspect import isfunction
from pathlib import Path
from typing import Any

import pytest

from greywhale.files.arm import load_arm
from greywhale.files.log import Log
from greywhale.files.trajectory import Trajectory
from greywhale.loop import multi_steps, steps
from greywhale.pictures import page
from greywhale.pictures.identification import Trace
from greywhale.protocol.table import ParameterTable
from greywhale_paper.pictures import curves, diagrams
from greywhale_paper.work import bench, errata, findings, on_the_bench, optimisers, readings
from greywhale_paper.work.arms import DEFAULT, file_of
from greywhale_paper.work.motions import MOTIONS
from tools.support import recordings

METHODS = ("gwo-woa", "gwo", "woa", "pso")
BUDGET = 40

followed = cache(on_the_bench.follow_as_paper)  # once for both that ask for it
_responses, _drawn = curves.responses, list[bytes]()


def as_paper(seed: int, seconds: float, period_ms: int, budget: int | None, traces: bool) -> dict[str, Any]:
    """In the place of greywhale's own tuning, which takes a hundred times as long."""
    assert budget is not None
    return follow(seed, seconds, period_ms, traces)


def follow(seed: int, seconds: float, period_ms: int, traces: bool, arm: str = DEFAULT) -> dict[str, Any]:
    """The paper's way."""
    return followed(seed, seconds, period_ms, traces, arm)


def recorded(
    folder: Path, name: str, motion: Trajectory, table: ParameterTable, seed: int = bench.BENCH_SEED, arm: str = DEFAULT
) -> Log:
    """By the native loop, which does what the bench does in a fraction of the time."""
    log = recordings.record(load_arm(file_of(arm, folder)), motion, folder / f"{name}.csv", table, seed)
    return replace(log, name=f"{name}.csv")


def responses(traces: Sequence[Trace], *titles: Any, **window: Any) -> bytes:
    """The first picture stands for all."""
    if not _drawn:
        _drawn.append(_responses(traces, *titles, **window))
    return _drawn[0]


def shrink(patch: pytest.MonkeyPatch) -> None:
    """Few methods, short motions, no long tuning, coarse pictures; the request is for one seed, quick."""
    patch.setattr(page, "DOCUMENT_DPI", 20)
    patch.setattr(curves, "responses", responses)
    patch.setattr(bench, "record", recorded)
    patch.setattr(on_the_bench, "follow_as_default", as_paper)
    patch.setattr(on_the_bench, "follow_as_paper", follow)
    patch.setattr(optimisers, "METHODS", METHODS)
    for name in ("pages.optimisers", "pages.findings"):
        patch.setattr(f"greywhale_paper.{name}.METHODS", METHODS)
    for name in ("grey_box.BUDGET", "optimisers.BUDGET", "optimisers.IDENTIFYING"):
        patch.setattr(f"greywhale_paper.work.{name}", BUDGET)
    patch.setattr("greywhale.identify.pack_search.BUDGET", 50)
    patch.setattr(optimisers, "functions", lambda: ("sphere",))
    patch.setattr(errata, "cases", lambda: {"E14": ("E14",), "E1 to E8": ("E2",)})
    patch.setattr(errata, "HOLD_S", 0.05)
    patch.setattr(errata, "SWING_S", 0.1)
    patch.setattr(findings, "PERIODS_MS", (1, 20))
    for name in ("work.readings", "work.findings", "pages.readings", "pages.claims"):
        patch.setattr(f"greywhale_paper.{name}.LENGTHS_S", (0.1, 0.15, 0.2, 0.25))
    patch.setattr(readings, "SMALL_STEP_S", 0.1)
    patch.setitem(MOTIONS, "steps", lambda: steps(1.0, 0.3, 0.8))
    patch.setitem(MOTIONS, "multi-steps", lambda: multi_steps([0.0, 1.0, -0.5], [0.3, 0.5, 0.8]))
    patch.setattr("greywhale_paper.request.Request.logged_s", 6.0)
    patch.setattr("greywhale_paper.request.Request.function_runs", 4)


def draw_nothing(patch: pytest.MonkeyPatch) -> None:
    """For tests of what is said around the pictures."""
    for module in (curves, diagrams):
        for name, one in list(vars(module).items()):
            if isfunction(one) and one.__annotations__.get("return") == "bytes":
                patch.setattr(module, name, lambda *data, **options: b"")
