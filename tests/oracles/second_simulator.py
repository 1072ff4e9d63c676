"""The Nano's image in avr8js, another simulator of the ATmega328P, and in our own: one scenario through both."""

from __future__ import annotations

import json
import os
import struct
import subprocess
from collections.abc import Callable, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from greywhale._native import Board
from greywhale.protocol import frames, schema
from greywhale.protocol.declared import Message
from greywhale_sim.programs import load_hex
from greywhale_sim.wiring import NANO
from tools import ROOT

IMAGE = ROOT / "firmware/.pio/build" / NANO.environment / "firmware.hex"
SCRIPTS = Path(__file__).parent / "avr8js"
NODE = {**os.environ, "NODE_PATH": str(ROOT / "build/avr8js/node_modules")}
PERIOD = 16_000
TICK_VECTOR = 14 * 4
# As in avr8js/lockstep.js.
FIRST, EACH, CONVERSIONS, CHANNELS = 2256, 416, 32, 8
OUTPUTS = struct.Struct("<HH")

Volts = NDArray[np.float32]


@dataclass(frozen=True)
class Scenario:
    """Voltages of shape (ticks, 32 conversions, 8 channels), the bytes to send by tick, inputs without a wire as bits.

    avr8js knows no such inputs.
    """

    volts: Volts
    sends: dict[int, bytes]
    floating: int = 0


@dataclass(frozen=True)
class Run:
    """Outputs at the end of each tick, of a Nano OCR1A, OCR1B, OCR2A, OCR2B, PORTB, PORTD; all bytes that it sent; its
    EEPROM at the end, of a board with cycles.
    """

    outputs: NDArray[Any]
    sent: bytes
    eeprom: bytes = b""


def request(message: type[Message], sequence: int, payload: bytes = b"") -> bytes:
    return frames.encode_frame(message.TYPE, sequence, payload)


def send_at(tick: int) -> int:
    """Cycles from a tick to what is sent in it."""
    return 4500 + tick * 61 % 5000


def run_avr8js(scenario: Scenario, folder: Path) -> Run:
    sends, volts = folder / "sends.json", folder / "volts.f32"
    sends.write_text(json.dumps({tick: data.hex() for tick, data in scenario.sends.items()}))
    volts.write_bytes(scenario.volts.astype("<f4").tobytes())
    command = ["node", str(SCRIPTS / "lockstep.js"), str(IMAGE), str(sends), str(volts), str(len(scenario.volts))]
    output = json.loads(subprocess.run(command, env=NODE, check=True, capture_output=True, text=True).stdout)
    outputs = np.array(output["outputs"][: len(scenario.volts)])
    return Run(outputs, bytes.fromhex(output["sent"]), bytes.fromhex(output["eeprom"]))


def run_board(scenario: Scenario) -> Run:
    board = Board("atmega328p")
    load_hex(board, IMAGE)
    return run_image(
        board,
        TICK_VECTOR,
        scenario,
        lambda: [*OUTPUTS.unpack(board.peek(0x88, 4)), *board.peek(0xB3, 2), *board.peek(0x25), *board.peek(0x2B)],
    )


def run_image(board: Any, tick_vector: int, scenario: Scenario, look: Callable[[], Sequence[float]]) -> Run:
    """Power our own board and run it; `look` at its outputs at the end of each tick."""
    board.power_on(1)
    board.set_millivolts(np.full(CHANNELS, 2500.0))
    board.set_floating(scenario.floating)
    while board.pc != tick_vector:
        board.run_until(board.cycle + 1)
    first = board.cycle
    outputs, sent = [], b""
    for tick, volts in enumerate(scenario.volts):
        start = first + tick * PERIOD
        for conversion in range(CONVERSIONS):
            change = start + FIRST + EACH * conversion - EACH // 2
            if change - EACH <= start + send_at(tick) < change and tick in scenario.sends:
                board.run_until(start + send_at(tick))
                board.uart_send(scenario.sends[tick])
            board.run_until(change)
            board.set_millivolts(1000.0 * volts[conversion].astype(float))
        board.run_until(start + PERIOD - 200)
        outputs.append(look())
        sent += board.uart_receive()
    return Run(np.array(outputs), sent, board.eeprom())


def parameter_requests(values: dict[str, int], sequence: int) -> list[bytes]:
    """The requests that stage and apply the defaults but for these values."""
    wanted = list(schema.DEFAULTS)
    for name, value in values.items():
        wanted[schema.PARAMETER_BY_NAME[name].index] = value
    staged = [
        request(schema.ParamSetRequest, sequence + i, struct.pack("<Hi", schema.PARAMETER_BY_NAME[name].index, value))
        for i, (name, value) in enumerate(values.items())
    ]
    apply = request(schema.ParamApplyRequest, sequence + len(staged), struct.pack("<H", schema.param_crc(wanted)))
    return [*staged, apply]
