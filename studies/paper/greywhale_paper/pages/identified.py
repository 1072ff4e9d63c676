"""By how much identified models are better than the white box, in each reading of the paper and on each arm."""

from __future__ import annotations

import numpy as np

from greywhale_paper.pages.document import Row, Sheet
from greywhale_paper.pages.found import Found
from greywhale_paper.pages.numbers import lower, several
from greywhale_paper.pages.printed import GREY_BOX_BETTER, GREY_BOX_BETTER_FITTED
from greywhale_paper.tasks import IDENTIFICATIONS
from greywhale_paper.work.arms import DEFAULT, OTHER_HAND, STICKY

ARMS = {
    DEFAULT: "the bench's default arm",
    STICKY: "an arm like the paper's",
    OTHER_HAND: "the same arm, led by another hand",
}
READINGS = {
    "paper": "paper's method, first pack at random",
    "paper-started": "the same, white box in the first pack",
    "gwo-woa": "GWO-WOA on logarithms, with Coulomb friction",
}


def arms_of(found: Found) -> dict[str, str]:
    """The arms on which an identification was judged, by what they are called."""
    return ARMS | {name: f"{name} around the white box" for name in found.request.drawn}


def gains(found: Found, method: str, arm: str, data_set: int) -> list[float]:
    """By how many per cent the model is better than the white box on a data set (0 to 2), a number a seed."""
    runs = found.identified(method, arm)
    return [lower(sum(run["white_box"][data_set]), sum(run["mse"][data_set])) for run in runs]


def table(found: Found) -> Sheet:
    rows = []
    for arm, said in arms_of(found).items():
        white = found.identified(IDENTIFICATIONS[0], arm)[0]["white_box"]
        rows.append(Row(f"{said}: the white box leaves {sum(white[0]):.2g} and {sum(white[1]):.2g} rad²"))
        for method in IDENTIFICATIONS:
            each = [gains(found, method, arm, place) for place in range(3)]
            worse = f"{int((np.array(each[1]) < 0.0).sum())} of {len(each[1])}"
            rows.append(Row(READINGS[method], (*(several(one, ".1f") for one in each), worse)))
    return Sheet(
        ("per cent better than the white box", "data set 1", "data set 2", "data set 3", "worse on set 2"),
        rows,
        notes=(
            f"The paper prints {GREY_BOX_BETTER_FITTED:g} % on data set 1, to which the models are fitted, and "
            f"{GREY_BOX_BETTER:g} % on data set 2; its white box leaves 0.40 and 0.43 rad². Data set 3 has other "
            "controllers. Each search evaluates 510 arms.",
        ),
    )
