"""Pictures: convergence (the paper's Fig. 6), responses of arm, white box and model to each log (Figs. 7-8)."""

from __future__ import annotations

from pathlib import Path

import numpy as np

from greywhale.base.types import Floats
from greywhale.identify.closed_loop import COMPARED_TICKS, Loop
from greywhale.identify.judge import JudgedLog, LogVerdict
from greywhale.identify.result import IdentificationResult
from greywhale.pictures import looks
from greywhale.pictures.names import distinct_names
from greywhale.pictures.page import (
    COLUMN,
    JOINTS,
    WIDE,
    headline,
    leave,
    legend_below,
    make_logarithmic,
    save_into,
    style,
)
from greywhale.pictures.plotting import Figure, plt
from greywhale.protocol.joints import ALL, Joints
from greywhale.simulate import plant_row


def draw(outcome: IdentificationResult, folder: Path) -> list[Path]:
    """Write the pictures into `folder`; their paths."""
    written = []
    with style():
        if outcome.found.curve:
            figure = plot_convergence(outcome.found.curve, outcome.method)
            written.append(save_into(figure, folder, "convergence.png"))
        names = distinct_names([one.name for one in outcome.verdicts])
        for number, (subject, verdict) in enumerate(zip(outcome.subjects, outcome.verdicts, strict=True), 1):
            if subject.table is not None:
                figure = _responses(outcome, subject, verdict, names[number - 1])
                written.append(save_into(figure, folder, f"responses_{number}.png"))
    return written


def plot_convergence(costs: tuple[float, ...], method: str) -> Figure:
    """The best cost so far, rad², over iterations; one column wide."""
    figure, axes = plt.subplots(figsize=(COLUMN, 2.5))
    figure.subplots_adjust(**leave(figure, 0.7, 0.12, 0.42, 0.3))
    axes.step(np.arange(1, len(costs) + 1), costs, where="post", **looks.MODEL.line)
    make_logarithmic(axes)
    axes.set_xlabel("iteration")
    axes.set_ylabel("best summed MSE [rad²]")
    axes.set_title(f"Identification, method {method}")
    return figure


def _responses(outcome: IdentificationResult, subject: JudgedLog, verdict: LogVerdict, name: str) -> Figure:
    assert subject.table is not None
    loop = Loop(subject.log, subject.table, outcome.white_box)
    white = loop.angles(plant_row(outcome.white_box)[None])[0]
    shifted = loop.with_zero(outcome.zero) if outcome.zero.any() else loop
    model = shifted.angles(outcome.plant[None])[0]
    rows = slice(0, COMPARED_TICKS * len(model), COMPARED_TICKS)
    said = [
        f"MSE [rad²]: {outcome.begun} {before:.2g},\nmodel {after:.2g}"
        for before, after in zip(verdict.white_box, verdict.model, strict=True)
    ]
    curves = {outcome.begun: white, "model": model}
    title = f"{name} ({verdict.role}); error: recorded less simulated"
    joints = outcome.white_box.joints_in_use
    return plot_responses(loop.time[rows], loop.leader[rows], loop.follower[rows], curves, said, title, joints)


def plot_responses(
    time: Floats,
    leader: Floats,
    follower: Floats,
    simulated: dict[str, Floats],
    said: list[str],
    title: str,
    joints: Joints = ALL,
) -> Figure:
    """Angles (rows, 4) in rad at `time` (s): leader, follower and what was simulated, and below how far that is off.

    `simulated` are two arms by their names: what the search began with, and the model.
    """
    rows = (len(joints) + 1) // 2
    figure = plt.figure(figsize=(WIDE, 6.7 if rows == 2 else 4.0))
    headline(figure, title)
    drawn = {
        "leader": (leader, looks.LEADER.thin(0.9)),
        "recorded follower": (follower, looks.FOLLOWER),
    }
    for (label, angles), look in zip(simulated.items(), (looks.WHITE_BOX, looks.MODEL), strict=True):
        drawn[label] = angles, look
    room = leave(figure, 0.67, 0.1, 0.62, 0.75)
    grid = figure.add_gridspec(rows, 2, **room, wspace=0.29, hspace=0.38)
    for place, joint in enumerate(joints):
        cells = grid[divmod(place, 2)].subgridspec(2, 1, height_ratios=(2.2, 1), hspace=0.07)
        angle = figure.add_subplot(cells[0])
        error = figure.add_subplot(cells[1], sharex=angle)
        for label, (angles, look) in drawn.items():
            angle.plot(time, angles[:, joint], label=label, **look.line)
        for label, angles in simulated.items():
            error.plot(time, follower[:, joint] - angles[:, joint], **drawn[label][1].thin().line)
        error.axhline(0.0, color=looks.DARK, linewidth=0.5)
        angle.set_title(f"{JOINTS[joint]}\n{said[joint]}")
        angle.tick_params(labelbottom=False)
        angle.set_ylabel("angle [rad]")
        angle.set_xlim(time[0], time[-1])
        error.set_ylabel("error [rad]")
        error.set_xlabel("time [s]")
        figure.align_ylabels([angle, error])
    handles, labels = angle.get_legend_handles_labels()
    legend_below(figure, handles, labels)
    return figure
