"""Pictures: convergence (the paper's Fig. 6), responses of arm, white box and model to each log (Figs. 7-8)."""

from __future__ import annotations

from pathlib import Path

import matplotlib

matplotlib.use("Agg")
import matplotlib.pyplot as plt
import numpy as np
from matplotlib.figure import Figure

from greywhale.errors import UserError, os_reason
from greywhale.formats.whole import write_whole
from greywhale.identify.closed_loop import COMPARED_TICKS, Loop
from greywhale.identify.judge import Subject, Verdict
from greywhale.identify.outcome import Outcome
from greywhale.loop import plant_row
from greywhale.report.follow import JOINT_NAMES

_RECORDED, _WHITE, _MODEL = "#222222", "#D55E00", "#0072B2"


def draw(outcome: Outcome, folder: Path) -> list[Path]:
    """Write the pictures into `folder`; their paths."""
    try:
        folder.mkdir(parents=True, exist_ok=True)
    except OSError as error:
        raise UserError(f"{folder}: cannot be made: {os_reason(error)}.") from None
    written = []
    if outcome.found.curve:
        written.append(_save(_convergence(outcome), folder / "convergence.png"))
    for number, (subject, verdict) in enumerate(zip(outcome.subjects, outcome.verdicts, strict=True), 1):
        if subject.table is not None:
            written.append(_save(_responses(outcome, subject, verdict), folder / f"responses_{number}.png"))
    return written


def _convergence(outcome: Outcome) -> Figure:
    figure, axes = plt.subplots(figsize=(7.0, 4.0))
    axes.semilogy(np.arange(1, len(outcome.found.curve) + 1), outcome.found.curve, color=_MODEL)
    axes.set_xlabel("iteration")
    axes.set_ylabel("best mean squared error [rad²]")
    axes.set_title(f"Convergence of the identification, method {outcome.method}")
    axes.grid(alpha=0.3)
    return figure


def _responses(outcome: Outcome, subject: Subject, verdict: Verdict) -> Figure:
    assert subject.table is not None
    loop = Loop(subject.log, subject.table, outcome.white_box)
    white = loop.angles(plant_row(outcome.white_box)[None])[0]
    shifted = loop.with_zero(outcome.zero) if outcome.zero.any() else loop
    model = shifted.angles(outcome.plant[None])[0]
    time = loop.time[::COMPARED_TICKS][: len(model)]
    figure, grid = plt.subplots(2, 2, figsize=(11.0, 7.0), sharex=True)
    for joint, axes in enumerate(grid.flat):
        axes.plot(time, loop.follower[::COMPARED_TICKS, joint], color=_RECORDED, linewidth=1.8, label="recorded")
        axes.plot(time, white[:, joint], color=_WHITE, linewidth=1.0, label="white box")
        axes.plot(time, model[:, joint], color=_MODEL, linewidth=1.0, label="model")
        errors = f"{verdict.white_box[joint]:.2g} -> {verdict.model[joint]:.2g} rad²"
        axes.set_title(f"Joint {joint}, {JOINT_NAMES[joint]}   (MSE {errors})", fontsize=9)
        axes.set_ylabel("angle [rad]")
        axes.grid(alpha=0.3)
    for axes in grid[1]:
        axes.set_xlabel("time [s]")
    handles, labels = grid[0, 0].get_legend_handles_labels()
    figure.legend(handles, labels, loc="lower center", ncols=3, frameon=False)
    figure.suptitle(f"{Path(verdict.name).name} ({verdict.role})", fontsize=11)
    return figure


def _save(figure: Figure, path: Path) -> Path:
    try:
        write_whole(path, lambda file: figure.savefig(file, format="png", dpi=120, metadata={"Software": None}))
    finally:
        plt.close(figure)
    return path
