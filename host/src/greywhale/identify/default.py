"""The default method: windows of the logs, then the closed loop, with as many quantities as held-out data support."""

from __future__ import annotations

import numpy as np

from greywhale.base.types import Floats
from greywhale.identify.bootstrap import scatter_of_fits, spread_covariance
from greywhale.identify.candidate import Candidate
from greywhale.identify.combinations import combinations
from greywhale.identify.found_model import FoundModel, ParameterEstimate, Rival
from greywhale.identify.knocking import turns_of
from greywhale.identify.request import IdentificationRequest
from greywhale.identify.samples import draw_plants, read_search
from greywhale.identify.search import Search
from greywhale.identify.space import KINDS, Space
from greywhale.identify.uncertainty import uncertainty
from greywhale.identify.windows import WindowResidual
from greywhale.loop.leader import SLICE_S

DRAWS = 60  # plants that tell how much better or worse a model may do by chance


def find_default(task: IdentificationRequest) -> FoundModel:
    """Run the search. An interrupt after the first model ends it early; before that, the interrupt is raised again.
    One while the model is judged, which takes a moment, leaves out the fits of simulated logs.
    """
    arm, joints = task.white_box, task.moving
    prepared = [subject.log for subject in task.fitted]
    search = Search(arm, prepared, task.loops(), joints, task.seed, task.report, _begin(task))
    try:
        search.run()
    except KeyboardInterrupt:
        if search.best is None:
            raise
    try:
        task.report("judging the model", 0.0)
        return _describe(task, search)
    except KeyboardInterrupt:
        search.complete = False
        return _describe(task, search)


def _describe(task: IdentificationRequest, search: Search) -> FoundModel:
    """The best model of a search with its doubts; with those that simulated logs show if the search is complete."""
    arm, joints, prepared, best = task.white_box, task.moving, search.logs, search.best
    assert best is not None
    windows = WindowResidual(prepared, arm, joints, longest_step=SLICE_S)
    for seen, _ in turns_of(windows, best.space, best.knocking):
        seen.settle(best.plant, best.zero)
    sure = uncertainty(windows, best.space, best.x, joints, best.knocking, to_read=True)
    if search.complete and search.loops:
        scatter = scatter_of_fits(
            prepared,
            search.loops,
            best.space,
            best.x,
            sure.covariance,
            joints,
            best.knocking,
            task.seed,
            lambda done: task.report("testing the fit", done),
        )
        sure = sure.widened(
            spread_covariance(sure.covariance, scatter, best.space, best.x, sure.limits), best.space, best.x, joints
        )
    return FoundModel(
        plant=best.plant,
        zero=best.zero,
        joints=joints,
        order=best.order,
        orders=tuple((one.order, float(one.held_out or 0.0)) for one in search.tried),
        combinations=combinations(best.space, best.x, sure.whole, sure.limits),
        rivals=tuple(Rival(one.order, float(one.held_out or 0.0), one.plant) for one in search.rivals()),
        estimates=estimates_of(best.space, best.x, sure.deviations),
        covariance=sure.covariance,
        draws=draw_plants(best.space, best.x, sure.covariance, DRAWS, task.seed),
        condition=sure.condition,
        open=sure.open,
        simulations=search.fits.simulations,
        simulated=search.fits.simulated,
        complete=search.complete,
    )


def _begin(task: IdentificationRequest) -> Candidate | None:
    """The model to begin with, in the search's own numbers: all quantities that it states of any joint."""
    if task.begin is None:
        return None
    known, x, _ = read_search(task.begin)
    kinds = tuple(dict.fromkeys(one.kind for one in known.parameters))
    space = Space.of(task.white_box, kinds, task.moving)
    low, high = space.bounds()
    facts = task.begin.identification or {}
    return Candidate(space, np.clip(space.translate(x, known), low, high), str(facts.get("order", "")))


def estimates_of(space: Space, x: Floats, deviations: Floats | None) -> tuple[ParameterEstimate, ...]:
    """Values and standard deviations as people read them: a logarithm's deviation is a share of the value."""
    start, values = space.values(space.start()), space.values(x)
    estimates = []
    for index, parameter in enumerate(space.parameters):
        kind = KINDS[parameter.kind]
        scale = float(values[index]) if kind.logarithmic else 1.0
        deviation = None if deviations is None else scale * float(deviations[index])
        before, after = float(start[index]), float(values[index])
        estimates.append(ParameterEstimate(parameter.name, kind.means, kind.unit, before, after, deviation))
    return tuple(estimates)
