"""Puts a bench together: board with bootloader and firmware, arm, potentiometers and leader, ready for power."""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np

from greywhale._native import Board, BoardError
from greywhale.base.errors import BAD_USAGE, UserError
from greywhale.board.flash import packaged_image
from greywhale.files.arm import load_arm
from greywhale.files.leader import load_leader
from greywhale.loop import human_reaches
from greywhale_sim import eeprom_file
from greywhale_sim.bench import SLICE_S, Bench, Plant
from greywhale_sim.drivers import CHIPS, Chip
from greywhale_sim.faults import inject
from greywhale_sim.leader_player import LeaderPlayer
from greywhale_sim.wiring import BOARDS, Wiring

BUILDS = Path(__file__).resolve().parents[3] / "firmware" / ".pio" / "build"


@dataclass(frozen=True)
class BenchOptions:
    """The choice of things that stand on the bench."""

    board: str = "mega"
    leader: Path | None = None  # CSV of the leader's motion; None: generated human-like reaches
    arm: Path | None = None  # TOML of the arm; None: the default one
    firmware: Path | None = None  # HEX to start with; None: the last build, or what came with greywhale
    driver: str = "drv8838"  # the motor drivers' chip
    blank: bool = False  # a board with nothing but its bootloader
    eeprom: Path | None = None  # file that keeps the EEPROM; None: forgotten at the end
    seed: int = 1  # of everything random
    faults: tuple[str, ...] = ()  # there from the beginning: NAME or NAME:PLACE


def chip_of(driver: str) -> Chip:
    if driver not in CHIPS:
        raise UserError(f'motor driver "{driver}" is not known; there are: {", ".join(CHIPS)}.', 2)
    return CHIPS[driver]


def wiring_of(board: str) -> Wiring:
    if board not in BOARDS:
        raise UserError(f'board "{board}" is not known; there are: {", ".join(BOARDS)}.', 2)
    return BOARDS[board]


def build_board(options: BenchOptions) -> Any:
    """A powered board: bootloader, firmware unless blank, EEPROM content."""
    from greywhale_sim.programs import load_hex  # pyelftools takes a while

    if options.blank and options.firmware is not None:
        raise UserError("a blank board has no firmware: leave out --blank or --firmware.", BAD_USAGE)
    wiring = wiring_of(options.board)
    if not wiring.bootloader.is_file():
        raise UserError(f"{wiring.bootloader}: the bootloader is missing; install greywhale anew.")
    board = Board(wiring.mcu)
    load_hex(board, wiring.bootloader, bootloader=True)
    if not options.blank:
        try:
            load_hex(board, _firmware(options, wiring))
        except BoardError as error:
            raise UserError(f"{error}.") from None
    if options.eeprom is not None:
        content = eeprom_file.load(options.eeprom, len(board.eeprom()))
        if content is not None:
            board.set_eeprom(content)
    board.power_on(options.seed)
    return board


def build_bench(options: BenchOptions, plant: Plant | None = None, leader: LeaderPlayer | None = None) -> Bench:
    """The whole bench; `plant` may be any object with step(voltages, dt) -> angles instead of the built-in arm, and
    another `leader` may play a motion of their own.
    """
    parameters = load_arm(options.arm or "default")
    if leader is None:
        motion = human_reaches(options.seed) if options.leader is None else load_leader(options.leader)
        leader = LeaderPlayer(motion, SLICE_S, joints=parameters.joints_in_use)
    bench = Bench(
        board=build_board(options),
        wiring=wiring_of(options.board),
        plant=parameters if plant is None else plant,
        leader=leader,
        pots=(parameters.leader_pots, parameters.follower_pots),
        supply_v=parameters.drive.supply,
        chip=chip_of(options.driver),
        emf=np.array([motor.torque_per_volt * motor.resistance for motor in map(parameters.actuator, range(4))]),
        joints=parameters.joints_in_use,
        seed=options.seed,
    )
    for fault in options.faults:
        inject(bench, fault)
    return bench


def _firmware(options: BenchOptions, wiring: Wiring) -> Path:
    if options.firmware is not None:
        if not options.firmware.is_file():
            raise UserError(f"{options.firmware}: there is no such firmware file.")
        return options.firmware
    built = BUILDS / wiring.environment / "firmware.hex"
    if built.is_file():
        return built
    packaged = packaged_image(options.board)
    if packaged is None:
        raise UserError(f"{built}: the firmware is not built; run: make firmware, or start with --blank and flash it.")
    return packaged
