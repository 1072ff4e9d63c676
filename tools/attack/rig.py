"""The real image with an arm on its pins, a leader that moves, and potentiometers or motors that can be made to lie.

Like the bench, in slices of 250 us, but without bootloader and serial port, and with the truth beside what the board is
told: the true error is the true leader minus the true follower.
"""

from __future__ import annotations

import struct
from collections.abc import Callable
from typing import Any

import numpy as np

from greywhale.arm import Arm, ArmParameters, Potentiometers
from greywhale.base.types import Floats
from greywhale.files.arm import default_arm
from greywhale.protocol import frames, schema
from greywhale.protocol.declared import Message
from greywhale_sim._board import Board
from greywhale_sim.symbols import read_symbols
from greywhale_sim.wiring import BOARDS
from tools import BUILT_FIRMWARE

Lie = Callable[[Floats, float], None]  # changes the eight voltages (mV) a time (s) after it began
Leader = Callable[[float], Floats]

SLICE_CYCLES, SLICE_S = 4000, 250e-6
CYCLES_PER_MS = 16_000
ASK_AGAIN_MS = 50
RAM = {"atmega2560": 0x200, "atmega328p": 0x100}


class Rig:
    """One board and its arm; the motors are off after the start."""

    def __init__(self, board: str, leader: Leader, seed: int, arm: ArmParameters | None = None) -> None:
        self.wiring = BOARDS[board]
        parameters = default_arm() if arm is None else arm
        self.random = np.random.default_rng(seed)
        self.supply_v = parameters.drive.supply
        self.arm = Arm(parameters, seed=seed)
        self._pots = [Potentiometers(parameters.leader_pots, seed), Potentiometers(parameters.follower_pots, seed + 1)]
        self.leader_of = leader
        self.running_set = 0
        self.motion_s = 0.0
        self.leader = leader(0.0)
        self.angles: Floats = self.leader.copy()
        self.lie: Lie | None = None
        self.lie_s = 0.0
        self.motor_signs = np.ones(4)
        self.stuck: dict[int, float] = {}
        self.board: Any = Board(self.wiring.mcu)
        elf = BUILT_FIRMWARE / self.wiring.environment / "firmware.elf"
        self.symbols = read_symbols(elf)
        self.board.load_elf(str(elf))
        self.board.power_on(seed)
        self.board.add_pin_output(self.wiring.enable.port, self.wiring.enable.bit)
        for motor in self.wiring.motors:
            self.board.add_duty_output(motor.pwm.timer, motor.pwm.channel)
        for motor in self.wiring.motors:
            self.board.add_pin_output(motor.direction.port, motor.direction.bit)
        self._millivolts = np.zeros(8)
        self.arm.reset(self.angles)
        self.run(0.08)

    # --- time

    @property
    def motors_on(self) -> bool:
        return bool(self.board.pin(self.wiring.enable.port, self.wiring.enable.bit))

    @property
    def true_error(self) -> Floats:
        return np.asarray(self.leader - self.angles)

    def run(self, seconds: float) -> None:
        for _ in range(round(seconds / SLICE_S)):
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
        self._pots[0].millivolts(self.leader, self._millivolts[:4])
        self._pots[1].millivolts(self.angles, self._millivolts[4:])
        if self.lie is not None:
            self.lie(self._millivolts, self.lie_s)
            self.lie_s += SLICE_S
        self.board.set_millivolts(self._millivolts)
        self.board.run_until(self.board.cycle + SLICE_CYCLES)

    # --- the host

    def ask(self, message: type[Message], payload: bytes = b"") -> bytes:
        """The payload of the answer; RuntimeError when the board refuses. A board that restarts is asked again."""
        self.board.uart_receive()
        decoder = frames.FrameDecoder()
        for attempt in range(200):
            if attempt % ASK_AGAIN_MS == 0:
                self.board.uart_send(b"\0" + frames.encode_frame(message.TYPE, 1, payload))
            self.run(0.001)
            for frame in decoder.feed(self.board.uart_receive()):
                if frame.type == message.TYPE | 0x80:
                    return bytes(frame.payload)
        raise RuntimeError(f"the firmware did not do as asked: {message.__name__}")

    def status(self) -> schema.StatusReply:
        return schema.StatusReply.unpack(self.ask(schema.StatusRequest))

    def apply(self, changes: dict[str, int]) -> None:
        """Run the defaults with these raw values, and find out where they lie."""
        values = list(schema.DEFAULTS)
        for name, raw in changes.items():
            index = schema.PARAMETER_BY_NAME[name].index
            values[index] = raw
            self.ask(schema.ParamSetRequest, struct.pack("<Hi", index, raw))
        self.ask(schema.ParamApplyRequest, struct.pack("<H", schema.param_crc(values)))
        self.run(0.005)
        start = RAM[self.wiring.mcu]
        self.running_set = start + self.board.peek(start, 2048).index(schema.TABLE.pack(values))

    def start(self) -> None:
        """All in order again, motors on, soft start over."""
        self.lie, self.lie_s = None, 0.0
        self.motor_signs[:] = 1.0
        self.stuck.clear()
        self.board.set_floating(0)
        self.board.let_pin_go(self.wiring.estop.port, self.wiring.estop.bit)
        self.ask(schema.StopRequest)
        self.motion_s = 0.0
        self.run(0.08)
        self.ask(schema.ClearFaultRequest)
        self.shift_phase()
        self.ask(schema.EnableRequest, struct.pack("<H", 0))
