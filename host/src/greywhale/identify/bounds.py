"""Doubts about estimates that lie at a bound of the search: something else than that quantity moved the arm."""

from __future__ import annotations

from collections.abc import Iterable

from greywhale.identify.found_model import ParameterEstimate
from greywhale.identify.space import KINDS, Parameter
from greywhale.identify.uncertainty import whose

_MOTOR = "as if the arm file has another motor, gear or supply, or lengths in another unit", "correct the arm file"
_LOAD = (
    "as if it was not calibrated, or the links or the load weigh otherwise than the arm file says",
    "calibrate it, weigh links and load, correct the arm file",
)
_WEAR = "as if a coupling or a gear has come loose", "tighten it"
_CABLES = "as if the battery is empty, a cable too thin or drive.supply of the arm file wrong", "correct that"
# Why an estimate may end at its least and at its most, and what would help; nothing where that is no wonder: an arm
# without gap, play or friction at rest is as good as any, and the search ends where more would explain nothing else.
CAUSES: dict[str, tuple[tuple[str, str] | None, tuple[str, str] | None]] = {
    "alpha": (_MOTOR, _MOTOR),
    "inertia": (_MOTOR, _MOTOR),
    "damping": (_MOTOR, _MOTOR),
    "coulomb": (None, _MOTOR),
    "gap": (None, _WEAR),
    "play": (None, _WEAR),
    "lag": (None, ("as if the wiper has a filter of its own, or the log is late", "look at the wiring")),
    "lost": (None, _CABLES),
    "uneven": (_CABLES, _CABLES),
    "sag": (None, _CABLES),
    "tip": (None, ("as if the links weigh otherwise than the arm file says", "weigh them, correct the arm file")),
    "offset": (_LOAD, _LOAD),
}


def doubt_bounds(estimates: Iterable[ParameterEstimate]) -> tuple[str, ...]:
    """A sentence for each estimate that went as far as it was let: what it may be instead, and what to do."""
    sentences = []
    for one in estimates:
        parameter = Parameter.from_name(one.name)
        kind = KINDS[parameter.kind]
        ends = ("least", kind.low), ("most", kind.high)
        for (end, bound), cause in zip(ends, CAUSES.get(parameter.kind, (None, None)), strict=True):
            if cause is None:
                continue
            value = one.white_box * bound if kind.logarithmic else bound
            if abs(kind.to_search(one.value) - kind.to_search(value)) > kind.step:
                continue
            sentences.append(
                f"{whose(parameter)}: {parameter.kind}, the {kind.means}, is {one.value:.3g} {kind.unit}, the {end} "
                f"that is searched, {cause[0]}: {cause[1]}, record and identify again."
            )
    return tuple(sentences)
