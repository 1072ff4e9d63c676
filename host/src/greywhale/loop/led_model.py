"""Simulates a played check on a model: the check's leader and controllers, the model in the arm's place."""

from __future__ import annotations

from collections.abc import Iterator

import numpy as np

from greywhale.arm import ArmParameters, PotentiometerBank
from greywhale.arm.limits import DOUBTS
from greywhale.arm.parameters import USUAL_TRACK_RAD, Potentiometer, with_usual_noise
from greywhale.arm.plants import plant_row
from greywhale.base.types import Controllers, Floats
from greywhale.loop.closed_loop import ClosedLoop, FollowerLines, known_readings, shown_angles, with_ideal_follower
from greywhale.loop.controllers import controllers_of
from greywhale.loop.traces import Traces
from greywhale.protocol.firmware import JOINTS, TICK_S, pwm_steps
from greywhale.protocol.table import ParameterTable

# The model stands at the log's first pose for so long before it is led, so that it starts at rest.
LEAD_TICKS = 500


class LedModel:
    """A model in the arm's place, under the leader of a log; `table` is the board's."""

    def __init__(self, arm: ArmParameters, table: ParameterTable, played: Traces) -> None:
        noisy = with_usual_noise(arm)
        zero = FollowerLines.of(arm, table).plus
        reference = np.vstack([np.tile(played.leader[:1], (LEAD_TICKS, 1)), played.leader])
        stops = [(joint.stops.min, joint.stops.max) for joint in arm.joint]
        home = [float(np.clip(angle, *stops[joint])) for joint, angle in enumerate(played.follower[0] + zero)]
        self._loop = ClosedLoop(
            with_ideal_follower(table),
            known_readings(reference, reference + zero),
            _read_by_an_ideal_board(noisy.follower_pots, zero),
            seed=5,  # any one, the same every time
            home=home,
            gap=[0.0] * JOINTS,
            weight_s=np.zeros(len(reference)),
        )
        self._zero, self._played = zero, played
        self._volts = table.supply_v / np.array(pwm_steps(table.board))

    def run(self, controllers: Controllers, plants: Floats) -> Iterator[Traces]:
        """The traces of controllers (n, 4, 13) on plants (n, columns), one of either for all."""
        found = self._loop.run(np.ascontiguousarray(controllers), np.ascontiguousarray(plants), substeps=2, every=1)
        each = np.ascontiguousarray(np.broadcast_to(plants, (len(found.angles), plants.shape[1])))
        for number, duties in enumerate(found.duties):
            (angles,) = shown_angles(found.angles[[number]], each[[number]], TICK_S)
            yield Traces(
                leader=self._played.leader,
                follower=np.nan_to_num(angles[LEAD_TICKS:], nan=10.0) - self._zero,
                voltage=duties[LEAD_TICKS:].astype(np.float64) * self._volts,
                begins=self._played.begins,
            )


def _read_by_an_ideal_board(pots: PotentiometerBank, zero: Floats) -> PotentiometerBank:
    """Usual potentiometers that read 0 at these angles (4,) rad, and are as noisy as those of the arm."""
    noise = [min(pot.noise * USUAL_TRACK_RAD / pot.track, DOUBTS.most_noise_v) for pot in pots.joint]
    usual = zip(zero.tolist(), noise, strict=True)
    return PotentiometerBank(
        supply=pots.supply, joint=tuple(Potentiometer(centre=centre, noise=size) for centre, size in usual)
    )


def predict(arm: ArmParameters, table: ParameterTable, played: Traces, plants: Floats | None = None) -> list[Traces]:
    """The traces that the model (or each of other plants) would have made with the table's controllers."""
    rows = plant_row(arm)[None] if plants is None else plants
    return list(LedModel(arm, table, played).run(controllers_of(table)[None], rows))
