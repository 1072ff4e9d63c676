"""An adaptation on a port: a person's work goes into the decisions, and the set they wish for onto the board.

Nothing that runs on trial is stored. Whatever ends the session early (Ctrl-C, a lost port, a fault), the motors go off
and the set from the start runs again, at the latest after the board's next start.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, replace
from pathlib import Path

import numpy as np

from greywhale.adapt.background import Background, background
from greywhale.adapt.change import SOFT_START_MS, RestWatch, SetChanger
from greywhale.adapt.decide import Adaptation
from greywhale.adapt.limits import ADAPTATION_LIMITS, AdaptationLimits, ChangeLimits
from greywhale.adapt.result import AdaptationResult, say
from greywhale.adapt.stretch import Collector
from greywhale.base.errors import UserError
from greywhale.base.study import Workers
from greywhale.base.types import NotedProgress, show_no_progress
from greywhale.board.device import Device, hold_ctrl_c
from greywhale.board.hunting_stop import Hunting, HuntingStop
from greywhale.board.limits import RECORDING
from greywhale.board.stream import Received, stream, why_stopped
from greywhale.board.upload import read_parameters, run_set, upload_set
from greywhale.files import controller as controller_file
from greywhale.protocol import schema
from greywhale.protocol.firmware import ANGLE_LSB
from greywhale.protocol.table import ParameterTable
from greywhale.tune.board_checks import refuse_uncalibrated
from greywhale.tune.model import Model, load_model

# Evaluations of one search in the background.
BUDGET = 300
SECONDS = 600.0


@dataclass(frozen=True)
class AdaptationRequest:
    """`seconds` of work on a port, by the board's clock. Controllers that are kept go into the file `out`.

    `workers` do the searches; in this process alone (`SerialWorkers`) the board would wait for them, so only a bench in
    lock step can bear that.
    """

    port: str
    model: Path
    out: Path
    workers: Workers
    seconds: float = SECONDS
    budget: int = BUDGET
    seed: int = 0
    judging: AdaptationLimits = ADAPTATION_LIMITS


def adapt(
    request: AdaptationRequest, report: NotedProgress = show_no_progress, warn: Callable[[], None] = lambda: None
) -> AdaptationResult:
    """Watch a person work for `request.seconds`, and adapt the controllers meanwhile.

    `warn` is called before the motors start.
    The set from the start runs again at the end; `store_kept` stores what was kept. Raises UserError.
    """
    model = load_model(request.model, force=True, judging=request.judging.tuning)
    with background(request.workers) as searches, Device(request.port) as device:
        start = read_parameters(device, report)
        refuse_uncalibrated(model.arm, start, request.judging.tuning.model)
        session = _Session(device, request, model, start, searches, report)
        try:
            warn()
            session.work()
            if session.changes:
                run_set(device, start, report)
        except BaseException as error:
            _put_back(device, start, session.changes, error)
            raise
        return session.result()


def store_kept(port: str, result: AdaptationResult, report: NotedProgress = show_no_progress) -> AdaptationResult:
    """Let the board run and store what an adaptation kept. Raises UserError."""
    with Device(port) as device:
        upload_set(device, result.kept, report)
    return replace(result, stored=True)


def _put_back(device: Device, start: ParameterTable, changes: int, error: BaseException) -> None:
    """Run the set from the start after an error or Ctrl-C; the motors are off by now."""
    if not changes:
        return
    with hold_ctrl_c():
        try:
            run_set(device, start)
        except UserError:
            error.add_note("The board runs the controllers from before again after its next start.")


class _Session:
    """The motors are on while it works."""

    def __init__(
        self,
        device: Device,
        request: AdaptationRequest,
        model: Model,
        start: ParameterTable,
        searches: Background,
        report: NotedProgress,
    ) -> None:
        self.changes = 0
        self._device, self._request, self._start = device, request, start
        self._searches, self._report = searches, report
        quick = start.with_raw({"soft_start_ms": SOFT_START_MS})  # the same set, as it runs while sets change
        self._limits = request.judging.changes
        self._core = Adaptation(
            replace(model, table=quick), quick, budget=request.budget, seed=request.seed, limits=request.judging
        )
        self._collector, self._changer = Collector(request.judging.samples), SetChanger(device, self._limits)
        self._rest, self._hunting = RestWatch(self._limits), HuntingStop()
        self._worked_s = 0.0
        self._bump = _Bump(self._limits)
        self._kept = self._core.kept  # what the file `out` holds, if it is not the start

    def work(self) -> None:
        received = stream(self._device, 1)
        with self._device.enabled(RECORDING.busy_lease_ms):
            pause = _Pause(self._limits.max_first_start_ticks)
            begun: int | None = None
            for one in received:
                if one.sample.state is schema.State.FAULT or pause.is_too_long(one):
                    raise why_stopped(self._device)
                if pause.lasts(one):
                    continue
                begun = one.elapsed if begun is None else begun
                self._worked_s = (one.elapsed - begun) / 1000
                if self._worked_s >= self._request.seconds:
                    break
                if self._take(one):
                    pause = _Pause(one.elapsed + self._limits.max_off_ticks)
        self._device.telemetry(0)

    def _take(self, one: Received) -> bool:
        """Look at a sample, and at what is to be done; True where the set was changed."""
        core = self._core
        self._rest.take(one)
        self._bump.take(one)
        try:
            self._hunting(one)
        except Hunting as hunting:
            core.hunted(hunting.joint)
            self._hunting = HuntingStop()
        stretch = self._collector.take(one)
        if stretch is not None:
            self._device.renew()  # what follows takes a moment
            core.take(stretch)
            self._think()
            self._tell()
        standby = core.standby
        if standby is not None:
            self._changer.prepare(standby)
        wish = core.wish
        if wish is None or not self._changer.is_ready(wish.table):
            return False
        if not (self._rest.resting or (wish.urgent and self._rest.is_close)):
            return False
        self._bump.begin(one)
        self.changes += 1
        self._changer.change()
        core.changed()
        self._collector.cut()
        self._rest, self._hunting = RestWatch(self._limits), HuntingStop()
        return True

    def _think(self) -> None:
        """Hand the background what is to be computed, and take what is done."""
        found = self._searches.take()
        if found is not None:
            self._core.answer(found)
        if not self._searches.busy:
            task = self._core.task()
            if task is not None:
                self._searches.begin(task)

    def _tell(self) -> None:
        core = self._core
        what = "waiting for a rest of the leader" if core.wish is not None else core.activity
        if core.kept is not self._kept:
            self._kept = core.kept
            self._keep_file()
        note = say(core.trials[-1]) if core.trials else core.doubt
        self._report(what, min(1.0, self._worked_s / self._request.seconds), note)

    def _keep_file(self) -> None:
        """Write down what was kept, so that it outlives whatever comes; what was given up again has no file."""
        if self._kept is self._core.start:
            self._request.out.unlink(missing_ok=True)
            return
        controller_file.save(
            self._request.out,
            self._kept.controllers,
            "greywhale adapt",
            header=(f"Kept after {self._worked_s:.0f} s of work: {self._core.trials[-1].why}.",),
        )

    def result(self) -> AdaptationResult:
        core = self._core
        return AdaptationResult(
            start=self._start,
            kept=self._start.with_controllers(np.array(core.kept.controllers, dtype=np.int32)),
            trials=tuple(core.trials),
            seconds=self._worked_s,
            searches=core.searches,
            changes=self.changes,
            bump_rad=self._bump.most_rad,
            model=core.live.changes(),
            note="a set was still on trial" if core.on_trial else core.doubt,
        )


class _Pause:
    """From a change of the set until the follower follows again. Samples from before the change still arrive first."""

    def __init__(self, most_ticks: int) -> None:
        self._most = most_ticks
        self._seen = self._over = False

    def lasts(self, one: Received) -> bool:
        following = one.sample.state is schema.State.FOLLOWING
        self._seen = self._seen or not following
        self._over = self._over or (following and (self._seen or one.elapsed > self._most))
        return not self._over

    def is_too_long(self, one: Received) -> bool:
        """True where the motors are off although nobody asked for that, or for longer than a change takes."""
        return one.sample.state is not schema.State.FOLLOWING and (self._over or one.elapsed > self._most)


class _Bump:
    """By how much a joint's error grows in a change of the set, at most, while its leader rests."""

    def __init__(self, limits: ChangeLimits) -> None:
        self._limits = limits
        self.most_rad = 0.0
        self._begun: Received | None = None

    def begin(self, one: Received) -> None:
        self._begun = one

    def take(self, one: Received) -> None:
        begun = self._begun
        if begun is None or one.elapsed % self._limits.look_every_samples:
            return
        if one.elapsed > begun.elapsed + self._limits.bump_ticks:
            self._begun = None
            return
        joints = zip(begun.sample.leader, begun.sample.follower, one.sample.leader, one.sample.follower, strict=True)
        for led, followed, leads, follows in joints:
            if abs(leads - led) < self._limits.still_rad / ANGLE_LSB:
                self.most_rad = max(self.most_rad, ANGLE_LSB * (abs(leads - follows) - abs(led - followed)))
