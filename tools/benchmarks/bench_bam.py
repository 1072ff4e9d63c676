"""`greywhale identify` on the public recordings of Rhoban's BAM, beside BAM's own models: errors on gains held out.

The recordings are not part of this project: GREYWHALE_BAM names their folder, see docs/real_data.md. BAM's models are
judged with its own published numbers where the folder holds them, and with numbers found from our share of the data.
"""

from __future__ import annotations

import os
import sys
from collections.abc import Iterator, Mapping, Sequence
from pathlib import Path
from typing import Any

import numpy as np

from greywhale.arm.from_plant import arm_of
from greywhale.identify import IdentificationResult, identify
from studies.real_data.bam_models import BOUNDS, errors, fit
from studies.real_data.bam_rig import Swing, mean_error, of_motions, read_folder
from studies.real_data.rigs import SERVO_RIG
from tools.benchmarks.figure import Figure

MOTIONS = ("sin_sin", "sin_time_square", "up_and_down")
LIVELY = MOTIONS[:2]  # in the third the servo stands at full voltage for seconds, which no model here explains
HELD_OUT = (200, 400)  # gains between others, one after the other
DRAWS = 20  # models that the fit allows as well, for an interval


def run() -> list[Figure]:
    folder = os.environ.get("GREYWHALE_BAM")
    if folder is None or not Path(folder).is_dir():
        print("GREYWHALE_BAM names no folder; docs/real_data.md says where BAM's recordings are.", file=sys.stderr)
        return []
    swings, published = read_folder(Path(folder))
    kps = sorted({one.kp for one in swings})
    return [figure for held in HELD_OUT if held in kps for figure in _figures(held, kps, swings, published)]


def _figures(
    held: int, kps: Sequence[int], swings: Sequence[Swing], published: Mapping[str, Mapping[str, Any]]
) -> Iterator[Figure]:
    judged, others = of_motions(swings, MOTIONS, [held]), [one for one in kps if one != held]
    name = f"bam, gain {held} held out"
    for motions, words in ((LIVELY, "lively motions"), (MOTIONS, "all motions")):
        fitted = of_motions(swings, motions, others)
        for model in BOUNDS:
            found = fit(model, fitted)
            yield _figure(f"{name}: BAM's {model}, {words}", errors(found, judged))
        ours = identify([one.log() for one in fitted], SERVO_RIG.arm())
        zero = ours.found.zero[SERVO_RIG.joint]
        low, high = _interval(ours, judged)
        yield Figure(
            f"{name}: greywhale, {words}", mean_error(ours.arm, zero, judged), "mrad", f"{low:.1f}..{high:.1f}"
        )
        for one in ours.estimates:
            deviation = "" if one.deviation is None else f"+- {one.deviation:.3g}"
            yield Figure(f"{name}: {one.name}, {words}", one.value, one.unit, deviation)
    for path, numbers in published.items():
        yield _figure(f"{name}: published {path}", errors(numbers, judged))


def _figure(name: str, found: np.ndarray) -> Figure:
    return Figure(name, 1e3 * float(found.mean()), "mrad")


def _interval(ours: IdentificationResult, judged: Sequence[Swing]) -> tuple[float, float]:
    """The middle 80 % of the errors of models that the fit allows as well."""
    draws, zero = ours.found.draws, ours.found.zero
    assert draws is not None
    arms = (arm_of(ours.white_box, plant, zero, "draw", "draw", None) for plant in draws[:DRAWS])
    low, high = np.percentile([mean_error(arm, zero[SERVO_RIG.joint], judged) for arm in arms], (10, 90))
    return float(low), float(high)
