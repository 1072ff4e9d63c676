"""Every figure of the report: nothing cut off, overlapping, too small or without a unit."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

import matplotlib.pyplot as plt
import numpy as np
import pytest
from matplotlib.figure import Figure

from greywhale.loop import multi_steps
from greywhale.pictures import looks
from greywhale.pictures.identification import Trace, plot_responses
from greywhale.pictures.page import LARGEST_ERROR, style
from greywhale_paper.pages.optimisers import SAID
from greywhale_paper.pictures import curves, diagrams
from greywhale_paper.work.errata import surface
from greywhale_paper.work.motions import printed
from tests.pictures.sight import faults

Draw = Callable[[], Any]


def traces() -> list[Trace]:
    time = np.arange(0.0, 16.0, 0.02)
    leader = multi_steps().at(time)
    late = np.vstack([np.repeat(leader[:1], 12, axis=0), leader[:-12]])
    rows = (
        ("leader", looks.LEADER, leader),
        ("before tuning", looks.BEFORE, late),
        ("paper's method, first seed", looks.PAPERS_METHOD, 0.98 * late),
        ("Table 10 as printed", looks.PRINTED, 0.5 * (late + leader)),
    )
    return [Trace(name, time, angles, look) for name, look, angles in rows]


def responses(**window: Any) -> bytes:
    all_of_them = traces()
    return curves.responses(all_of_them, all_of_them[0], "Multi-steps, tuned", "leader less follower", **window)


def joints() -> list[list[dict[str, list[float]]]]:
    falling = [{"evaluations": [10.0, 50.0, 310.0], "cost": [scale, 0.4 * scale, 0.1 * scale]} for scale in range(1, 5)]
    return [falling, falling]


FIGURES: dict[str, Draw] = {
    "responses": responses,
    "close up": lambda: responses(window=(1.3, 2.7)),
    "convergence": lambda: curves.convergence(
        {"seed 0": [9.0, 1.0, 0.02], "seed 1": [9.0, 2.0, 0.03]}, "Identification"
    ),
    "convergence of joints": lambda: curves.convergence_of_joints(joints(), "Tuning the sets", 10),
    "sets before": lambda: curves.sets_before(printed("before_tuning")),
    "tuneable": curves.tuneable,
    "sets after": lambda: curves.sets_after(
        printed("before_tuning"), {"Table 10": printed("table_10"), "paper's method, first seed": printed("table_9")}
    ),
    "surfaces": lambda: curves.surfaces(
        {name: surface(printed(key), 0) for name, key in (("before tuning", "before_tuning"), ("Table 10", "table_10"))}
    ),
    "ranks": lambda: curves.ranks(
        {
            problem: {name: 1.0 + place for place, name in enumerate(SAID.values())}
            for problem in ("identification", "tuning", "plain functions", "shifted functions")
        },
        "Mean ranks",
    ),
    "system": diagrams.system,
    "identification": diagrams.identification,
    "law": diagrams.law,
    "scheme": diagrams.scheme,
    "closed loop": diagrams.closed_loop,
    "arm": diagrams.arm,
}


@pytest.mark.slow
@pytest.mark.parametrize("name", FIGURES)
def test_nothing_is_cut_off_overlaps_or_lacks_a_unit(name: str, monkeypatch: pytest.MonkeyPatch) -> None:
    seen: list[list[str]] = []

    def look(figure: Figure) -> bytes:
        seen.append(faults(figure))
        plt.close(figure)
        return b""

    for module in (curves, diagrams):
        monkeypatch.setattr(module, "png", look)
    FIGURES[name]()
    assert seen == [[]]


def test_the_errors_are_the_differences_and_what_leaves_the_panel_is_marked() -> None:
    drawn = traces()
    with style():
        figure = plot_responses(drawn, drawn[0], "Title", "leader less follower")
    angle, strip = figure.axes[:2]
    assert [line.get_color() for line in angle.get_lines()] == [one.look.colour for one in drawn]
    for line, one in zip(strip.get_lines(), drawn[1:], strict=False):
        np.testing.assert_allclose(np.asarray(line.get_ydata()), drawn[0].angles[:, 0] - one.angles[:, 0])
        assert (line.get_color(), line.get_linestyle()) == (one.look.colour, one.look.style)
    assert strip.get_ylim() == (-LARGEST_ERROR, LARGEST_ERROR)
    words = [text.get_text() for text in figure.legends[0].get_texts()]
    assert words[4] == "error: leader less follower"
    assert words[5].startswith("beyond ±0.2 rad (up to ")
