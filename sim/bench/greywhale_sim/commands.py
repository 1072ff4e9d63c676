"""The commands to a running bench, one a line (docs/bench.md); every answer is one JSON object."""

from __future__ import annotations

import math
import shlex
from collections.abc import Callable
from typing import Any

import numpy as np

from greywhale import arm
from greywhale.base.errors import UserError
from greywhale.files.leader import load_leader
from greywhale_sim import faults, person_commands
from greywhale_sim.bench import CLOCK_HZ
from greywhale_sim.faults import POTS
from greywhale_sim.motions import MOTIONS
from greywhale_sim.server import Server

CommandAnswer = dict[str, Any]
QUIT = "quit"  # obeyed by whoever reads the commands
FARTHEST_RAD = 6.28  # a turn, of an angle in a command
MOST_SUPPLY_V = 30.0  # of the motors
MOST_LOAD_KG = 2.0  # at the end of the arm
MOST_PUSH_NM = 20.0  # on a joint
SLOWEST_SPEED = 0.05  # simulated seconds a second
_WIRINGS = {
    "connected": arm.Wiring.CONNECTED,
    "open": arm.Wiring.OPEN,
    "floating": arm.Wiring.CONNECTED,
    "shorted": arm.Wiring.SHORTED,
}
_POT_FAULTS = {kind.name.lower().replace("_", "-"): kind for kind in arm.PotFault}


def run(server: Server, text: str) -> CommandAnswer:
    """Carry out one command; a bad one raises UserError and changes nothing."""
    try:
        name, *words = shlex.split(text) or [""]
    except ValueError as error:
        raise UserError(f'"{text.strip()}" is not understood: {error}.', 2) from None
    if name not in COMMANDS:
        raise UserError(f'"{name}" is not a bench command; there are: {", ".join((*COMMANDS, QUIT))}.', 2)
    command, usage = COMMANDS[name]
    try:
        return command(server, *words)
    except (TypeError, ValueError):  # wrong number of words, or a word that is no number
        raise UserError(f'"{text.strip()}" is not understood; say: {name} {usage}.', 2) from None


def status(server: Server) -> CommandAnswer:
    """Tell time, motors, voltages, angles, resets, EEPROM writes, and who is connected."""
    bench, stats = server.bench, server.board.stats()
    return {
        "time_s": round(server.bench.time_s, 6),
        "cycle": server.board.cycle,
        "powered": server.board.powered,
        "motors_enabled": bench.motors_enabled,
        "voltages": [round(float(volts), 3) for volts in bench.voltages],
        "leader": [round(float(angle), 5) for angle in bench.leader.angles],
        "follower": [round(float(angle), 5) for angle in bench.angles],
        "estop_pressed": bench.estop_pressed,
        "clutch_pressed": bench.clutch_pressed,
        "leader_plays": bench.leader.plays,
        "in_bootloader": server.board.in_bootloader,
        "connected": server.port.connected,
        "resets": stats.resets,
        "watchdog_resets": stats.watchdog_resets,
        "eeprom_writes": stats.eeprom_writes,
        "rx_overruns": stats.rx_overruns,
        "resets_by_host": server.resets_by_host,
    }


def leader(server: Server, file: str) -> CommandAnswer:
    """The person plays another motion, of a file or a generated one: at once while the arm follows, else from the next
    enable on; quote a path with blanks."""
    motion = MOTIONS[file].make() if file in MOTIONS else load_leader(file)
    server.bench.leader.take_up(motion)
    return {"leader": file, "duration_s": motion.duration_s}


def hand(server: Server, side: str, *words: str) -> CommandAnswer:
    """While the motors are off the person brings an arm, or both, to these angles (rad) within some seconds (1), and
    holds it until the next enable."""
    angles, seconds = np.array([float(word) for word in words[:4]]), float(words[4]) if len(words) == 5 else 1.0
    if side not in ("leader", "follower", "both") or not 4 <= len(words) <= 5 or not 0.0 < seconds <= 60.0:
        raise ValueError
    if not np.all(np.abs(angles) <= FARTHEST_RAD):
        raise ValueError
    server.bench.leader.bring(angles if side != "follower" else None, angles if side != "leader" else None, seconds)
    return {"hand": side, "arrives_s": round(server.bench.time_s + seconds, 6)}


def pot(server: Server, side: str, joint: str, state: str) -> CommandAnswer:
    """A wire off with a pull-down (open) or without (floating), or shorted to the supply; frozen: the shaft does not
    turn; slipping: it loses three tenths of every way up; loose: off for 2 ms in 230 ms; noise or mains hum; the ends
    of its track exchanged (reversed); the shaft half a turn farther (dead-zone); wiper and end exchanged (crossed)."""
    if side not in ("leader", "follower") or not 0 <= int(joint) <= 3 or state not in (*_WIRINGS, *_POT_FAULTS):
        raise ValueError
    number = int(joint) + (4 if side == "follower" else 0)
    server.bench.set_wiring(number, _WIRINGS.get(state, arm.Wiring.CONNECTED))
    server.bench.let_float(number, state == "floating")
    server.bench.inject(number, _POT_FAULTS.get(state))
    return {"pot": f"{side}_{joint}", "state": state}


def swap(server: Server, one: str, other: str) -> CommandAnswer:
    """Exchange the wires of two potentiometers, leader0 to follower3."""
    server.bench.swap(POTS.index(one), POTS.index(other))
    return {"swapped": [one, other]}


def mistake(server: Server, words: str) -> CommandAnswer:
    """Stage a person's mistake, or take all back (none)."""
    if words == "list":
        return {"mistakes": {one.name: one.says for one in faults.FAULTS}}
    return {"staged": words, "says": faults.inject(server.bench, words)}


def pins(server: Server) -> CommandAnswer:
    """Tell the highest duty of each driver and the longest time that they were on, since the last pins."""
    duties, longest = server.bench.take_pins_seen(server.board.cycle)
    return {"duties": [round(duty, 5) for duty in duties], "longest_on_s": round(longest / CLOCK_HZ, 6)}


def motor(server: Server, joint: str, state: str) -> CommandAnswer:
    """Swap a motor's wires, take one off, leave a fifth of its torque, or connect another joint's driver."""
    gains = {"connected": 1.0, "reversed": -1.0, "dead": 0.0, "weak": faults.WEAK_GAIN}
    driver = int(joint) if state in gains else int(state)
    if not 0 <= int(joint) <= 3 or not 0 <= driver <= 3:
        raise ValueError
    server.bench.wire_motor(int(joint), gains.get(state, 1.0), driver)
    return {"motor": int(joint), "state": state}


def estop(server: Server, action: str) -> CommandAnswer:
    """The emergency stop's button, which closes its pin to ground."""
    if action not in ("press", "release"):
        raise ValueError
    server.bench.press_estop(action == "press")
    return {"estop_pressed": server.bench.estop_pressed}


def clutch(server: Server, action: str) -> CommandAnswer:
    """The clutch's pedal, which closes its pin to ground."""
    if action not in ("press", "release"):
        raise ValueError
    server.bench.press_clutch(action == "press")
    return {"clutch_pressed": server.bench.clutch_pressed}


def line(server: Server, what: str, probability: str) -> CommandAnswer:
    """Damage or lose bytes on the line, both ways."""
    server.noise.set(what, float(probability))
    return {"flip": server.noise.flip, "lose": server.noise.lose}


def power(server: Server, switch: str, writes: str = "0") -> CommandAnswer:
    """Cut or restore the board's supply; off 20 cuts it after 20 more bytes written to the EEPROM."""
    if switch not in ("on", "off") or not 0 <= int(writes) <= 100_000:
        raise ValueError
    if switch == "on":
        server.power_on()
    else:
        server.power_off(int(writes))
    return {"powered": server.board.powered}


def speed(server: Server, value: str) -> CommandAnswer:
    """Change the speed."""
    rate = 1.0 if value == "max" else float(value)
    if not SLOWEST_SPEED <= rate <= 1.0:
        raise ValueError
    server.fast, server.rate = value == "max", rate
    return {"speed": value}


def lead(server: Server, *words: str) -> CommandAnswer:
    """The person leads to these angles (rad) as quickly as a hand does, motors on or off; leader and hand end it."""
    angles = np.array([float(word) for word in words])
    if len(words) != 4 or not np.all(np.abs(angles) <= FARTHEST_RAD):
        raise ValueError
    server.bench.leader.lead(angles)
    return {"lead": angles.tolist()}


def supply(server: Server, volts: str) -> CommandAnswer:
    """Another supply for the motors, 0 to 30 V."""
    if not 0.0 <= float(volts) <= MOST_SUPPLY_V:
        raise ValueError
    server.bench.change_supply(float(volts))
    return {"supply_v": server.bench.supply_v}


def load(server: Server, mass: str) -> CommandAnswer:
    """A load at the tip, 0 to 2 kg."""
    if not 0.0 <= float(mass) <= MOST_LOAD_KG:
        raise ValueError
    server.bench.load_tip(float(mass))
    return {"load_kg": float(mass)}


def obstacle(server: Server, joint: str, degrees: str) -> CommandAnswer:
    """Put something hard in a joint's way, or take it away."""
    angle = None if degrees == "none" else math.radians(float(degrees))
    if not 0 <= int(joint) <= 3 or (angle is not None and not abs(angle) <= FARTHEST_RAD):
        raise ValueError
    server.bench.obstruct(int(joint), angle)
    return {"obstacle": int(joint), "angle": angle}


def push(server: Server, joint: str, torque: str) -> CommandAnswer:
    """A hand pushes on a joint of the follower, until the next push; 0 lets go."""
    if not 0 <= int(joint) <= 3 or not abs(float(torque)) <= MOST_PUSH_NM:
        raise ValueError
    server.bench.push(int(joint), float(torque))
    return {"push": int(joint), "torque_nm": float(torque)}


def controls(server: Server) -> CommandAnswer:
    """Tell what of this can be changed, between which ends, and how it is now."""
    bench = server.bench
    low, high = (np.clip(ends, -FARTHEST_RAD, FARTHEST_RAD).tolist() for ends in bench.stops)
    found: CommandAnswer = {
        "leader": {"minimum": low, "maximum": high},
        "faults": [
            {**faults.facts(one), "places": [place for place in faults.WHERE[one.on] if place]} for one in faults.FAULTS
        ],
        "motions": [{"name": name, "title": motion.title} for name, motion in MOTIONS.items()],
        "supply": {"minimum": 0.0, "maximum": MOST_SUPPLY_V, "value": bench.supply_v},
        "speed": {"minimum": SLOWEST_SPEED, "maximum": 1.0, "value": server.rate},
        "power": server.board.powered,
    }
    if bench.tip_kg is not None:
        found["load"] = {"minimum": 0.0, "maximum": MOST_LOAD_KG, "value": bench.tip_kg}
    return found


COMMANDS: dict[str, tuple[Callable[..., CommandAnswer], str]] = {
    "status": (status, ""),
    "leader": (leader, f"FILE.csv|{'|'.join(MOTIONS)}"),
    "lead": (lead, "A0 A1 A2 A3"),
    "hand": (hand, "leader|follower|both A0 A1 A2 A3 [SECONDS]"),
    "turn": (person_commands.turn, "leader|follower 0..3 [SECONDS]"),
    "hold": (person_commands.hold, "DEGREES, once or four times"),
    "hang": (person_commands.hang, ""),
    "pot": (pot, f"leader|follower 0..3 {'|'.join((*_WIRINGS, *_POT_FAULTS))}"),
    "swap": (swap, "POT POT"),
    "mistake": (mistake, "NAME[:PLACE]|none|list"),
    "pins": (pins, ""),
    "motor": (motor, "0..3 connected|reversed|dead|weak|0..3"),
    "estop": (estop, "press|release"),
    "clutch": (clutch, "press|release"),
    "line": (line, "flip|lose PROBABILITY"),
    "power": (power, "on|off [WRITES]"),
    "help": (person_commands.explain, ""),
    "supply": (supply, "VOLTS"),
    "load": (load, "KG"),
    "obstacle": (obstacle, "0..3 DEGREES|none"),
    "push": (push, "0..3 NM"),
    "speed": (speed, f"{SLOWEST_SPEED:g}..1|max"),
    "controls": (controls, ""),
}


def markdown_list() -> str:
    """All commands for the documentation, each with what its function says."""
    return "\n".join(
        f"- `{f'{name} {usage}'.strip()}`: {' '.join((command.__doc__ or '').split())}"
        for name, (command, usage) in COMMANDS.items()
    )
