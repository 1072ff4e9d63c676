"""A pulse as the drivers see it: voltage, time and way on the pins of the real image, not as it reports them."""

from __future__ import annotations

from dataclasses import dataclass, field

import numpy as np
import pytest

from greywhale.board.calibrate.motors import LEASE_MS, PULSE_STEP_RAD, pulse_table
from greywhale.board.calibrate.rules import PULSE_SHARES
from greywhale.protocol import schema
from greywhale.protocol.firmware import STEP_LSB
from greywhale.protocol.table import ParameterTable
from greywhale_sim.assemble import BenchOptions, build_bench
from greywhale_sim.bench import CLOCK_HZ
from tests.end_to_end.conftest import LockStep
from tests.end_to_end.test_lock_step import set_parameters

pytestmark = pytest.mark.slow
TABLE = ParameterTable.defaults()
PWM_STEP_V = TABLE.supply_v / 400
# Of the arm itself, coasting included; with a motor the wrong way round until `tracking` stops it.
FARTHEST_RAD = {1.0: 0.21, -1.0: 0.38}


@dataclass
class Seen:
    """Records of the drivers' pins and of the arm."""

    volts: np.ndarray = field(default_factory=lambda: np.zeros(4))  # most, of each motor
    on: list[int] = field(default_factory=list)  # cycles with the drivers enabled
    angles: list[np.ndarray] = field(default_factory=list)

    def look(self, cycle: int, pins: np.ndarray, angles: np.ndarray) -> None:
        self.angles.append(angles.copy())
        if pins[0]:
            self.on.append(cycle)
            self.volts = np.maximum(self.volts, np.abs(pins[1:5]) * TABLE.supply_v)


@pytest.mark.parametrize("sign", [1.0, -1.0], ids=["right", "reversed"])
@pytest.mark.parametrize("joint", [1, 3])  # the heaviest and the lightest
def test_the_strongest_pulse_keeps_its_limits_on_the_pins(joint: int, sign: float) -> None:
    """The host asks for nothing after the point, as one that was killed."""
    host = LockStep(build_bench(BenchOptions()))
    host.boot()
    volts = PULSE_SHARES[-1] * TABLE.supply_v
    set_parameters(host, pulse_table(TABLE, joint, volts).changes())
    host.bench.wire_motor(joint, sign, joint)
    for way in (1, -1):
        host.run(3.0)  # the person brings the arm back
        seen = Seen()
        host.bench.trace = seen.look
        begun = host.ask(schema.LeadRequest(LEASE_MS))
        step = [0, 0, 0, 0]
        step[joint] = way * round(PULSE_STEP_RAD / STEP_LSB)
        host.send(schema.LeadPointRequest(begun.next, (step[0], step[1], step[2], step[3])))
        host.run(1.0)
        host.bench.trace = None
        assert (seen.on[-1] - seen.on[0]) / CLOCK_HZ <= LEASE_MS / 1000 + 0.002
        assert 0.5 * volts < seen.volts[joint] <= volts + PWM_STEP_V
        assert np.delete(seen.volts, joint) == pytest.approx(0.0)
        assert np.abs(np.array(seen.angles)[:, joint] - seen.angles[0][joint]).max() <= FARTHEST_RAD[sign]
        if host.status().state is schema.State.FAULT:
            set_parameters(host, pulse_table(TABLE, joint, volts).with_raw({"tracking_limit": 0}).changes())
            host.run(3.0)
            host.ask(schema.ClearFaultRequest())
            set_parameters(host, pulse_table(TABLE, joint, volts).changes())
