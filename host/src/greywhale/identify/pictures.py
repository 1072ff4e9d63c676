"""All pictures of an identification, in a folder."""

from __future__ import annotations

from pathlib import Path

from greywhale.identify.closed_loop import COMPARED_TICKS, Loop
from greywhale.identify.judge import JudgedLog, LogVerdict
from greywhale.identify.result import IdentificationResult
from greywhale.loop import plant_row
from greywhale.pictures import looks
from greywhale.pictures.identification import Trace, plot_convergence, plot_responses
from greywhale.pictures.names import distinct_names
from greywhale.pictures.page import save_into, style
from greywhale.pictures.plotting import Figure


def draw(outcome: IdentificationResult, folder: Path) -> list[Path]:
    """Write the pictures into `folder`; their paths."""
    written = []
    with style():
        if outcome.found.curve:
            title = f"Identification, method {outcome.method}"
            figure = plot_convergence({"": outcome.found.curve}, title, looks.MODEL)
            written.append(save_into(figure, folder, "convergence.png"))
        names = distinct_names([one.name for one in outcome.verdicts])
        for number, (subject, verdict) in enumerate(zip(outcome.subjects, outcome.verdicts, strict=True), 1):
            if subject.table is not None:
                figure = _responses(outcome, subject, verdict, names[number - 1])
                written.append(save_into(figure, folder, f"responses_{number}.png"))
    return written


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
    time = loop.time[rows]
    traces = (
        Trace("leader", time, loop.leader[rows], looks.LEADER.thin(0.9)),
        recorded := Trace("recorded follower", time, loop.follower[rows], looks.FOLLOWER),
        Trace(outcome.begun, time, white, looks.WHITE_BOX),
        Trace("model", time, model, looks.MODEL),
    )
    joints, title = outcome.white_box.joints_in_use, f"{name} ({verdict.role})"
    return plot_responses(traces, recorded, title, "recorded less simulated", joints=joints, said=said)
