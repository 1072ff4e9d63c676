"""The real image with an arm on its pins, a leader that moves, and potentiometers or motors that can have faults.

Like the bench, in slices of 250 us, but without bootloader and serial port, and with the truth beside what the board is
told: the true error is the true leader minus the true follower.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping

import numpy as np

from greywhale.arm import Arm, Potentiometers
from greywhale.base.types import Floats
from greywhale.files.arm import default_arm
from greywhale.protocol import schema
from greywhale.protocol.declared import Reply_co, Request
from greywhale_sim.board_with_image import BoardWithImage

PotFault = Callable[[Floats, float], None]  # changes the eight voltages (mV) a time (s) after it began
Leader = Callable[[float], Floats]

SLICE_CYCLES, SLICE_S = 4000, 250e-6


class ArmOnBoard(BoardWithImage):
    """One board and its arm; the motors are off after the start."""

    def __init__(self, board: str, leader: Leader, seed: int) -> None:
        parameters = default_arm()
        self.supply_v = parameters.drive.supply
        self.arm = Arm(parameters, seed=seed)
        self._pots = [Potentiometers(parameters.leader_pots, seed), Potentiometers(parameters.follower_pots, seed + 1)]
        self.leader_of = leader
        self.running_set = 0
        self.motion_s = 0.0
        self.leader = leader(0.0)
        self.angles: Floats = self.leader.copy()
        self.pot_fault: PotFault | None = None
        self.pot_fault_s = 0.0
        self.motor_signs = np.ones(4)
        self.stuck: dict[int, float] = {}
        super().__init__(board, seed)
        self.random = np.random.default_rng(seed)

    def boot(self) -> None:
        self.board.add_pin_output(self.wiring.enable.port, self.wiring.enable.bit)
        for motor in self.wiring.motors:
            self.board.add_duty_output(motor.pwm.timer, motor.pwm.channel)
        for motor in self.wiring.motors:
            self.board.add_pin_output(motor.direction.port, motor.direction.bit)
        self.arm.reset(self.angles)
        self.wait(80)

    # --- time

    @property
    def true_error(self) -> Floats:
        return np.asarray(self.leader - self.angles)

    def wait(self, ms: float) -> None:
        for _ in range(round(ms / 1000 / SLICE_S)):
            self.slice()

    def shift_phase(self) -> None:
        """Let some of a slice pass, so that a tick begins elsewhere in it."""
        self.board.run_until(self.board.cycle + int(self.random.integers(SLICE_CYCLES)))

    def slice(self) -> None:
        """250 us of everything. With the motors off somebody holds the follower where the leader is."""
        enable, *values = self.board.outputs().tolist()
        if enable:
            volts = [duty if high else -duty for duty, high in zip(values[:4], values[4:], strict=True)]
            self.arm.step(np.array(volts) * self.motor_signs * self.supply_v, SLICE_S, self.angles)
            self.motion_s += SLICE_S
        self.leader = self.leader_of(self.motion_s)
        if not enable:
            self.arm.reset(self.leader)
            self.angles[:] = self.leader
        for joint, angle in self.stuck.items():
            self.angles[joint] = angle
        self._pots[0].millivolts(self.leader, self.millivolts[:4])
        self._pots[1].millivolts(self.angles, self.millivolts[4:])
        if self.pot_fault is not None:
            self.pot_fault(self.millivolts, self.pot_fault_s)
            self.pot_fault_s += SLICE_S
        self.board.set_millivolts(self.millivolts)
        self.board.run_until(self.board.cycle + SLICE_CYCLES)

    # --- the host

    def ask(self, request: Request[Reply_co]) -> Reply_co:
        """A board that restarts is asked again; a zero ends what the line carried before."""
        self.board.uart_send(b"\0")
        try:
            return super().ask(request)
        except RuntimeError:
            self.wait(50)
            self.board.uart_send(b"\0")
            return super().ask(request)

    def run_set(self, changes: Mapping[str, int]) -> None:
        """Run the defaults with these raw values, and find out where they lie."""
        values = self.apply(changes, fresh=True)
        self.wait(5)
        start, end = self.ram
        self.running_set = start + self.board.peek(start, end - start).index(schema.TABLE.pack(values))

    def start(self) -> None:
        """All in order again, motors on, soft start over."""
        self.pot_fault, self.pot_fault_s = None, 0.0
        self.motor_signs[:] = 1.0
        self.stuck.clear()
        self.board.set_floating(0)
        self.board.set_joined(0, 1)
        self.board.let_pin_go(self.wiring.estop.port, self.wiring.estop.bit)
        self.ask(schema.StopRequest())
        self.motion_s = 0.0
        self.wait(80)
        self.ask(schema.ClearFaultRequest())
        self.shift_phase()
        self.ask(schema.EnableRequest(0))
