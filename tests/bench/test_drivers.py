"""Motor drivers: what each chip makes of its pins, the current in an open bridge, following through each of them."""

from __future__ import annotations

import math

import numpy as np
import pytest

from greywhale._native import Bridge, bridge_of, mean_volts
from greywhale.protocol import schema
from greywhale.protocol.firmware import TICK_S
from greywhale_sim.assemble import BUILDS, BenchOptions, build_bench
from greywhale_sim.drivers import CHIPS
from greywhale_sim.symbols import read_symbols
from tests.end_to_end.conftest import LockStep
from tests.end_to_end.test_lock_step import set_parameters

SUPPLY_V = 12.0
PWM_S = 50e-6
ELECTRICAL_S = 0.3e-3  # inductance over resistance of a small geared motor
STEPS = 1000  # of a PWM period, in the integration


Shares = tuple[float, float, float]  # of a period: forwards, backwards, shorted


def bridge(chip: str, pins: dict[str, float], enable: bool = True) -> Shares:
    levels = {"pwm": 0.0, "direction": 0.0, "second_pwm": 0.0, "second_direction": 0.0, **pins}
    return shares(
        bridge_of(
            CHIPS[chip].kind,
            enable=enable,
            pwm=levels["pwm"],
            direction=bool(levels["direction"]),
            second_pwm=levels["second_pwm"],
            second_direction=bool(levels["second_direction"]),
        )
    )


def shares(one: Bridge) -> Shares:
    return one.forwards, one.backwards, one.shorted


OPEN, SHORTED = (0.0, 0.0, 0.0), (0.0, 0.0, 1.0)


@pytest.mark.parametrize(
    ("chip", "pins", "expected"),
    [
        ("drv8838", {"pwm": 0.25, "direction": 1}, (0.25, 0.0, 0.75)),
        ("drv8838", {"pwm": 0.25}, (0.0, 0.25, 0.75)),
        ("tb6612", {"pwm": 0.25, "direction": 1}, (0.25, 0.0, 0.75)),
        ("tb6612", {"pwm": 0.25, "second_direction": 1}, (0.0, 0.25, 0.75)),
        ("tb6612", {"pwm": 0.25, "direction": 1, "second_direction": 1}, SHORTED),
        ("tb6612", {"pwm": 0.25}, OPEN),
        ("l298n", {"pwm": 0.25, "direction": 1}, (0.25, 0.0, 0.0)),
        ("l298n", {"pwm": 0.25, "second_direction": 1}, (0.0, 0.25, 0.0)),
        ("l298n", {"pwm": 0.25}, (0.0, 0.0, 0.25)),
        ("drv8871", {"pwm": 0.25}, (0.25, 0.0, 0.0)),
        ("drv8871", {"second_pwm": 0.25}, (0.0, 0.25, 0.0)),
        ("drv8871", {"pwm": 1.0, "second_pwm": 0.75}, (0.25, 0.0, 0.75)),
        ("drv8871", {"pwm": 0.75, "second_pwm": 1.0}, (0.0, 0.25, 0.75)),
        ("bts7960", {"pwm": 0.25}, (0.25, 0.0, 0.75)),
        ("bts7960", {"pwm": 1.0, "second_pwm": 0.75}, (0.25, 0.0, 0.75)),
    ],
)
def test_a_chip_does_what_its_truth_table_says(
    chip: str, pins: dict[str, float], expected: tuple[float, float, float]
) -> None:
    assert bridge(chip, pins) == expected


@pytest.mark.parametrize("chip", ["tb6612", "drv8833", "bts7960"])
def test_a_disabled_chip_lets_its_motor_coast(chip: str) -> None:
    assert bridge(chip, {"pwm": 1.0, "direction": 1}, enable=False) == OPEN


@pytest.mark.parametrize("chip", CHIPS)
def test_pins_that_are_low_drive_no_motor(chip: str) -> None:
    """As after a reset, when the board drives no pin and the chips' pull-downs do."""
    assert bridge(chip, {}, enable=False)[:2] == (0.0, 0.0)


@pytest.mark.parametrize("emf_v", [-11.0, -0.5, 0.0, 4.0, 11.0])
@pytest.mark.parametrize("duty", [0.02, 0.4, 0.95])
def test_the_current_of_an_open_bridge_is_that_of_the_circuit(duty: float, emf_v: float) -> None:
    found = mean_volts(Bridge(duty, 0.0, 0.0), SUPPLY_V, emf_v)
    assert found == pytest.approx(emf_v + integrated_current(duty, emf_v), abs=0.03)
    assert mean_volts(Bridge(0.0, duty, 0.0), SUPPLY_V, -emf_v) == pytest.approx(-found)


def integrated_current(duty: float, emf_v: float) -> float:
    """Mean current times resistance: the circuit in small steps, its diodes too, until its periods are the same."""
    dt, current, mean, before = PWM_S / STEPS / ELECTRICAL_S, 0.0, 0.0, math.inf
    while abs(mean - before) > 1e-6:
        before, total = mean, 0.0
        for step in range(STEPS):
            on = step < duty * STEPS
            if not on and current == 0.0:
                break
            volts = SUPPLY_V if on else -math.copysign(SUPPLY_V, current)
            after = current + dt * (volts - emf_v - current)
            total += current
            current = 0.0 if not on and after * current < 0.0 else after
        mean = total / STEPS
    return mean


def test_an_open_bridge_without_pulses_leaves_a_motor_alone() -> None:
    assert mean_volts(Bridge(*OPEN), SUPPLY_V, 3.0) == 3.0
    assert mean_volts(Bridge(*SHORTED), SUPPLY_V, 3.0) == 0.0


def bench_with(chip: str) -> LockStep:
    host = LockStep(build_bench(BenchOptions(driver=chip)))
    host.boot()
    return host


def follow(host: LockStep, signals: int, **parameters: int) -> None:
    """Through these drivers, past the soft start."""
    set_parameters(host, {"driver": signals, **parameters})
    host.ask(schema.ClearFaultRequest())
    host.ask(schema.EnableRequest(0))
    host.run(1.5)


def following_error(chip: str, signals: int, **parameters: int) -> np.ndarray:
    """(4,) rad rms over two seconds with the paper's controllers, from the arm itself."""
    host = bench_with(chip)
    follow(host, signals, **parameters)
    apart: list[np.ndarray] = []
    host.bench.trace = lambda cycle, pins, angles: apart.append(host.bench.leader.angles - angles)
    host.run(2000 * TICK_S)
    assert host.status().fault is schema.Fault.NONE
    rms: np.ndarray = np.sqrt(np.mean(np.array(apart) ** 2, axis=0))
    return rms


@pytest.fixture(scope="module")
def usual() -> np.ndarray:
    return following_error("drv8838", 0)


@pytest.mark.slow
@pytest.mark.parametrize(("chip", "signals"), [("tb6612", 1), ("bts7960", 2), ("drv8871", 3)])
def test_an_arm_follows_alike_through_every_driver_that_brakes(chip: str, signals: int, usual: np.ndarray) -> None:
    """But for where friction stops them, which the noise of the potentiometers decides. Coasting costs far more."""
    assert following_error(chip, signals) == pytest.approx(usual, rel=0.1)


@pytest.mark.slow
@pytest.mark.parametrize(("chip", "signals"), [("l298n", 1), ("drv8871", 2)])
def test_an_arm_follows_through_drivers_that_coast(chip: str, signals: int, usual: np.ndarray) -> None:
    """Short pulses give hardly any current, so it stays behind. By the default limit a joint would count as stalled."""
    found = following_error(chip, signals, stall_volts=0)
    assert np.all(found < 0.2)
    assert np.any(found > 2.0 * usual)


@pytest.mark.slow
@pytest.mark.parametrize(("chip", "signals"), [("l298n", 1), ("drv8871", 2), ("l298n-jumpers", 3)])
def test_no_motor_is_driven_after_a_stop_a_hang_or_a_reset(chip: str, signals: int) -> None:
    """Not in any slice of 250 us by chips that have no enable input; a hang may take its 16 ms to end."""
    host = bench_with(chip)
    pulses: list[bool] = []
    host.bench.trace = lambda cycle, pins, angles: pulses.append(any(one.duty > 0.0 for one in host.bench.bridges))
    for end, within_s in ((stop, 0.001), (hang, 0.019), (reset, 0.001)):
        follow(host, signals, stall_volts=0)
        assert pulses[-1]
        end(host)
        host.run(within_s)
        pulses.clear()
        host.run(2.0)  # in which a person brings the arms back
        assert pulses
        assert not any(pulses), end.__name__


def stop(host: LockStep) -> None:
    host.ask(schema.StopRequest())


def hang(host: LockStep) -> None:
    """Send the processor into avr-libc's endless loop behind main(), which begins with turning interrupts off."""
    symbols = read_symbols(BUILDS / host.bench.wiring.environment / "firmware.elf")
    host.board.pc = symbols["_exit"].address


def reset(host: LockStep) -> None:
    host.board.reset()
