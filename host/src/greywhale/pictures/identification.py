"""Pictures of an identification: convergence (the paper's Fig. 6), responses of arm and models (Figs. 7-8)."""

from __future__ import annotations

import numpy as np

from greywhale.base.types import Floats
from greywhale.pictures import looks
from greywhale.pictures.page import COLUMN, JOINTS, WIDE, headline, leave, legend_below, make_logarithmic
from greywhale.pictures.plotting import Figure, plt
from greywhale.protocol.joints import ALL, Joints


def plot_convergence(costs: tuple[float, ...], method: str) -> Figure:
    """The best cost so far, rad², over iterations; one column wide."""
    figure, axes = plt.subplots(figsize=(COLUMN, 2.5))
    figure.subplots_adjust(**leave(figure, 0.7, 0.12, 0.42, 0.3))
    axes.step(np.arange(len(costs)), costs, where="post", **looks.MODEL.line)
    make_logarithmic(axes)
    axes.set_xlabel("iteration")
    axes.set_ylabel("best summed MSE [rad²]")
    axes.set_title(f"Identification, method {method}")
    return figure


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
