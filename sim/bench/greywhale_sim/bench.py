"""The bench: board, arm and leader in lock step on one simulated clock.

Time advances in slices of 250 us. In each slice the bench reads the driver pins, moves the arm under the voltages that
they mean, puts all eight potentiometers on the converter's inputs and lets the processor run. Nothing here looks at the
wall clock: the same bytes into the serial port at the same cycles give the same trace.
"""

from __future__ import annotations

import functools
import math
from collections.abc import Callable
from typing import Protocol

import numpy as np

from greywhale import arm
from greywhale.arm.parameters import Stops, Tip
from greywhale.base.errors import UserError
from greywhale.base.types import Floats
from greywhale.protocol.joints import ALL, Joints
from greywhale_sim.board_supply import SharedSupply
from greywhale_sim.drivers import CHIPS, OPEN, Bridge, Chip, Pins, mean_volts
from greywhale_sim.leader_player import LeaderPlayer
from greywhale_sim.pins_seen import PinsSeen
from greywhale_sim.wiring import Pin, Wiring

CLOCK_HZ = 16_000_000
SLICE_CYCLES = 4000
SLICE_S = SLICE_CYCLES / CLOCK_HZ
SLICES_PER_S = CLOCK_HZ // SLICE_CYCLES
CRASHED = 2


class Board(Protocol):
    """The interface of the simulated Arduino that the bench uses (greywhale_sim._board.Board)."""

    @property
    def cycle(self) -> int: ...
    @property
    def pc(self) -> int: ...
    @property
    def crash_reason(self) -> str: ...
    def add_duty_output(self, timer: int, channel: str) -> int: ...
    def add_pin_output(self, port: str, bit: int) -> int: ...
    def hold_pin(self, port: str, bit: int, high: bool) -> None: ...
    def let_pin_go(self, port: str, bit: int) -> None: ...
    def outputs(self) -> Floats: ...
    def set_millivolts(self, millivolts: Floats) -> None: ...
    def set_floating(self, inputs: int) -> None: ...
    def set_joined(self, inputs: int, wipers: int) -> None: ...
    def set_supply(self, millivolts: int, seed: int = 1) -> None: ...
    def run_until(self, cycle: int) -> int: ...


class Plant(Protocol):
    """The follower arm: any object that turns four motor voltages into four joint angles after `dt` seconds."""

    def step(self, voltages: Floats, dt: float) -> Floats: ...


class Potentiometers(Protocol):
    """Four angles in rad to four voltages in mV, written into `out`."""

    def millivolts(self, angles: Floats, out: Floats) -> Floats: ...


class CrashError(UserError):
    """The program did what no program should do: an invalid instruction, or an access outside the memory."""


# Called after every slice: cycle reached, pins at its beginning, follower's angles. The arrays are reused.
Trace = Callable[[int, Floats, Floats], None]


class Bench:
    """Lock step of one board, one plant and one leader; `run` is synchronous and deterministic."""

    def __init__(
        self,
        board: Board,
        wiring: Wiring,
        plant: Plant,
        leader: LeaderPlayer,
        leader_pots: Potentiometers,
        follower_pots: Potentiometers,
        supply_v: float,
        chip: Chip = CHIPS["drv8838"],
        emf: Floats | None = None,  # V s of each motor at its output shaft; needed where a chip lets motors coast
        joints: Joints = ALL,  # in use; the others have no potentiometers and no motor
    ) -> None:
        self.board = board
        self.wiring = wiring
        self.chip = chip
        self.emf: Floats = np.zeros(4) if emf is None else emf
        self.estop_pressed = self.clutch_pressed = False
        self.pot_faults = arm.PotFaults()
        self.joints = joints
        # -1: both wires of a motor are swapped; 0: one is off; 0.2: it is weak
        self.motor_gains = [1.0 if joint in joints else 0.0 for joint in ALL]
        self.motor_wires = [0, 1, 2, 3]  # which driver each motor is on
        self.floating = 0  # bit i: the wire of potentiometer i is off and nothing pulls its input
        self.plant = plant
        self._stops = self._own_stops = stops_of(plant)
        self._pushes: Floats = np.zeros(4)  # N m
        self.leader = leader
        self.leader_pots = leader_pots
        self.follower_pots = follower_pots
        self.supply_v = self.own_supply_v = supply_v
        self.shared_supply: SharedSupply | None = None  # None: the board has a supply of its own
        self.seen = PinsSeen()
        self.voltages: Floats = np.zeros(4)
        self.angles: Floats = leader.home.copy()
        self.trace: Trace | None = None
        board.add_pin_output(wiring.enable.port, wiring.enable.bit)
        for motor in wiring.motors:
            board.add_duty_output(motor.pwm.timer, motor.pwm.channel)
        for motor in wiring.motors:
            board.add_pin_output(motor.direction.port, motor.direction.bit)
        self._second = add_second_outputs(board, wiring)
        self.bridges = [OPEN] * 4
        self._coasts = False
        self._millivolts = np.zeros(8)
        self._last_outputs = b""
        self._enabled = False
        if joints != ALL:
            self.connect_all()
        self.place(leader.home)

    @property
    def time_s(self) -> float:
        return self.board.cycle / CLOCK_HZ

    @property
    def motors_enabled(self) -> bool:
        """The drivers' enable pin, as it is now."""
        return bool(self.board.outputs()[0])

    def press_estop(self, pressed: bool) -> None:
        """Press the emergency stop, which closes to ground, or release it."""
        self._ground(self.wiring.estop, pressed)
        self.estop_pressed = pressed

    def press_clutch(self, pressed: bool) -> None:
        """Press the clutch's pedal, which closes to ground, or release it."""
        self._ground(self.wiring.clutch, pressed)
        self.clutch_pressed = pressed

    def _ground(self, pin: Pin, closed: bool) -> None:
        if closed:
            self.board.hold_pin(pin.port, pin.bit, False)
        else:
            self.board.let_pin_go(pin.port, pin.bit)

    def wire_motor(self, joint: int, gain: float, driver: int) -> None:
        """Put a motor on a driver (0..3), the right way (1), the wrong way (-1) a wire off (0), or weak (0.2)."""
        self.motor_gains[joint] = gain if joint in self.joints else 0.0
        self.motor_wires[joint] = driver
        self._last_outputs = b""

    def connect_all(self) -> None:
        """Put every motor and potentiometer where it belongs; those of joints that are not in use are not there."""
        for joint in ALL:
            self.wire_motor(joint, 1.0, joint)
            for pot in (joint, joint + len(ALL)):
                self.let_float(pot, False)

    def change_supply(self, volts: float) -> None:
        """Give the motors another supply."""
        self.supply_v = volts
        self._last_outputs = b""

    def load_tip(self, mass_kg: float) -> None:
        """Let the arm carry so many kg."""
        self._build_anew(self._own_arm().parameters.model_copy(update={"tip": Tip(mass=mass_kg)}))

    def obstruct(self, joint: int, angle: float | None) -> None:
        """Put something hard in a joint's way, at an angle (rad) on either side of it; None takes it away."""
        parameters = self._own_arm().parameters
        low, high = (float(ends[joint]) for ends in self._own_stops)
        if angle is not None and low < angle < high:
            low, high = (low, angle) if angle > self.angles[joint] else (angle, high)
        joints = list(parameters.joint)
        joints[joint] = joints[joint].model_copy(update={"stops": Stops(min=low, max=high)})
        self._build_anew(parameters.model_copy(update={"joint": tuple(joints)}))

    def push(self, joint: int, torque_nm: float) -> None:
        """Let a hand push on a joint of the follower, until the next call."""
        self._pushes[joint] = torque_nm
        self._own_arm().set_load(self._pushes)

    def _own_arm(self) -> arm.Arm:
        if not isinstance(self.plant, arm.Arm):
            raise UserError("only the bench's own arm can be loaded, pushed or obstructed.")
        return self.plant

    def _build_anew(self, parameters: arm.ArmParameters) -> None:
        """Build the plant anew where the arm is, at rest."""
        self.plant = arm.Arm(parameters)
        self._stops = stops_of(self.plant)
        self.plant.reset(self.angles)
        self.plant.set_load(self._pushes)

    @property
    def tip_kg(self) -> float | None:
        """The mass that the arm carries; None for an arm that cannot be loaded."""
        return self.plant.parameters.tip.mass if isinstance(self.plant, arm.Arm) else None

    def let_float(self, pot: int, floats: bool) -> None:
        """Take the wire off a potentiometer (0..3 leader, 4..7 follower) without a pull-down, or put it back."""
        floats = floats or pot % len(ALL) not in self.joints
        self.floating = self.floating & ~(1 << pot) | floats << pot
        self.board.set_floating(self.floating)

    def touch(self, one: int, other: int) -> None:
        """Let the wires of two potentiometers' wipers touch."""
        self.pot_faults.touch(one, other)
        self.board.set_joined(1 << one | 1 << other, 2)

    def place(self, angles: Floats) -> None:
        """Hold the follower in a pose by hand, if the plant allows that (it has `reset`); no hand moves it beyond its
        stops.
        """
        reset = getattr(self.plant, "reset", None)
        if reset is not None:
            self.angles[:] = np.maximum(self._stops[0], np.minimum(self._stops[1], angles))
            reset(self.angles)

    def run(self, seconds: float) -> None:
        """Advance by `seconds` of simulated time, rounded to whole slices."""
        self.run_slices(round(seconds * SLICES_PER_S))

    def run_slices(self, count: int) -> None:
        board, leader, millivolts = self.board, self.leader, self._millivolts
        outputs, run_until, set_millivolts = board.outputs, board.run_until, board.set_millivolts
        step, advance, angles = self._stepper(), leader.step, self.angles
        leader_pots, follower_pots = self.leader_pots.millivolts, self.follower_pots.millivolts
        leader_millivolts, follower_millivolts = millivolts[:4], millivolts[4:]
        target = board.cycle // SLICE_CYCLES * SLICE_CYCLES
        held = None  # the pose in which the plant was held in the slice before
        for _ in range(count):
            target += SLICE_CYCLES
            pins = outputs()
            if pins.tobytes() != self._last_outputs:
                self._drive(pins)
            if self._coasts:
                self._coast()
            if leader.hold is None:
                step(self.voltages, SLICE_S, angles)
            elif leader.hold is held and isinstance(self.plant, arm.Arm):  # half of what `place` takes
                self.plant.reset(angles)
            else:
                self.place(leader.hold)
            held = leader.hold
            advance(self._enabled, angles)
            leader_pots(leader.angles, leader_millivolts)
            follower_pots(angles, follower_millivolts)
            if self.pot_faults.any:
                self.pot_faults.apply(millivolts)
            set_millivolts(millivolts)
            if self.shared_supply is not None:
                self.shared_supply.look(self.voltages)
            if run_until(target) == CRASHED:
                raise CrashError(
                    f"the program on the simulated board crashed at address {board.pc:#07x}: {board.crash_reason}."
                )
            if self.trace is not None:
                self.trace(target, pins, angles)

    def _stepper(self) -> Callable[[Floats, float, Floats], object]:
        """The plant's step, which writes into an array; the built-in arm can do that itself, which saves time."""
        plant = self.plant
        if isinstance(plant, arm.Arm):
            return plant.step

        def step(voltages: Floats, dt: float, out: Floats) -> None:
            out[:] = plant.step(voltages, dt)

        return step

    def _drive(self, pins: Floats) -> None:
        """The output of the drivers' chips for these pins: voltages, or motors that coast between pulses."""
        self._last_outputs = pins.tobytes()
        enable, *values = pins.tolist()
        self._enabled = bool(enable)
        enabled, chip, bridges = self._enabled, self.chip.bridge, self.bridges
        for driver in range(4):  # quicker than array arithmetic on so few numbers
            second = values[driver + 8 :: 4] if self._second else (0.0, 0.0)
            bridges[driver] = _bridge(chip, enabled, values[driver], values[driver + 4], *second)
        duties = [bridge.duty for bridge in bridges]
        self.seen.look(self.board.cycle, enabled or any(duties), duties)
        self._coasts = any([bridge.open for bridge in bridges])  # noqa: C419 (quicker than a generator)
        for joint, driver in enumerate(self.motor_wires):
            self.voltages[joint] = self.motor_gains[joint] * self.supply_v * bridges[driver].drive

    def _coast(self) -> None:
        """The voltages of motors whose bridges are open for a while depend on how fast these motors turn."""
        speeds = getattr(self.plant, "motor_velocities", None)
        emf = self.emf * speeds if speeds is not None else np.zeros(4)
        for joint, driver in enumerate(self.motor_wires):
            gain, bridge = self.motor_gains[joint], self.bridges[driver]
            if bridge.open > 0.0:
                self.voltages[joint] = math.copysign(1.0, gain) * mean_volts(
                    bridge, abs(gain) * self.supply_v, math.copysign(1.0, gain) * float(emf[joint])
                )


@functools.lru_cache(4096)  # the duties are few, and they change at every tick
def _bridge(
    of: Callable[[Pins], Bridge], enabled: bool, pwm: float, direction: float, second_pwm: float, second: float
) -> Bridge:
    return of(Pins(enabled, pwm, bool(direction), second_pwm, bool(second)))


def stops_of(plant: Plant) -> tuple[Floats, Floats]:
    """The lowest and highest angles of a follower, where its plant says them."""
    if not isinstance(plant, arm.Arm):
        return np.full(4, -np.inf), np.full(4, np.inf)
    stops = [joint.stops for joint in plant.parameters.joint]
    return np.array([stop.min for stop in stops]), np.array([stop.max for stop in stops])


def add_second_outputs(board: Board, wiring: Wiring) -> bool:
    """Read the second inputs of the motors as well, all PWM first; False for a board that has no pins for them."""
    pairs = [(motor.second_pwm, motor.second_direction) for motor in wiring.motors]
    if any(pwm is None or direction is None for pwm, direction in pairs):
        return False
    for pwm, _ in pairs:
        assert pwm is not None
        board.add_duty_output(pwm.timer, pwm.channel)
    for _, direction in pairs:
        assert direction is not None
        board.add_pin_output(direction.port, direction.bit)
    return True
