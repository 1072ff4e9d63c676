"""The controller core: cycles on the simulated ATmega2560, searched for the worst, and distance from the exact law."""

from __future__ import annotations

import struct
import subprocess
from fractions import Fraction
from pathlib import Path

import numpy as np

from greywhale import _native
from greywhale._native import Board
from greywhale.fuzzy import exact, load_joints, twin
from greywhale.fuzzy.settings import SET_UNIT, JointSettings
from greywhale_sim.programs import load_elf
from greywhale_sim.symbols import read_symbols
from tools import ROOT, avr_tool
from tools.benchmarks.figure import Figure, at_most
from tools.support.fuzzy_on_board import FuzzyOnBoard
from tools.support.fuzzy_search import LARGEST, Point, Random, climb

TABLES = ROOT / "shared/fuzzy_tables"
FLOAT_SOURCE = Path(__file__).with_name("fuzzy_float.cpp")
FLOAT_ELF = ROOT / "build/fuzzy_float.elf"
PERIOD_MS = 20  # the paper's
DRAWS, CLIMBS = 20_000, 1_500


def run() -> list[Figure]:
    return [*_cycles(), *_float_cycles(), *_planes(), *_least_exact()]


def _figures(name: str, costs: list[float], reach: str = "", aim: float | None = None) -> list[Figure]:
    """min and mean of the random draws, worst of all."""
    drawn = costs[:-1]
    return [
        Figure(f"{name}, least", min(drawn), "cycles"),
        Figure(f"{name}, mean", float(np.mean(drawn)), "cycles"),
        Figure(f"{name}, worst found", max(costs), "cycles", reach, None if aim is None else max(costs) <= aim),
    ]


def _cycles() -> list[Figure]:
    board = FuzzyOnBoard()
    compiling: list[float] = []

    def inference(point: Point) -> float:
        compiling.append(board.compile(point.settings, point.period_ms)[1])
        board.set_state(0, point.previous)
        return board.inference_cycles(point.e)

    def period(point: Point) -> float:
        board.compile(point.settings, point.period_ms)
        board.set_state(point.integral, point.previous)
        return board.period_cycles(point.e, point.limit_mv)

    inferring = climb(inference, Random(1), DRAWS, CLIMBS)
    stepping = climb(period, Random(2), DRAWS, CLIMBS)
    return [
        *_figures("fuzzy: inference", inferring, "<= 450 cycles", 450),
        *_figures("fuzzy: PD+I of one joint", stepping),
        Figure("fuzzy: deriving one joint's coefficients, worst", max(compiling), "cycles"),
    ]


def _float_cycles() -> list[Figure]:
    """Cycles of these rules in float, as one would first write them."""
    FLOAT_ELF.parent.mkdir(exist_ok=True)
    command = [
        avr_tool("avr-g++"),
        "-std=gnu++14",
        "-O2",
        "-mmcu=atmega2560",
        str(FLOAT_SOURCE),
        "-o",
        str(FLOAT_ELF),
        "-lm",
    ]
    subprocess.run(command, check=True)
    board = Board("atmega2560")
    load_elf(board, FLOAT_ELF)
    board.power_on(1)
    board.run_until(20_000)  # variables and stack
    symbols = read_symbols(FLOAT_ELF)
    figures = []
    grid = np.linspace(-1, 1, 21)
    for name, text in (("mamdani", "float Mamdani, 101 samples"), ("singletons", "float singletons")):
        cycles = []
        for x in grid:
            for y in grid:
                board.poke(0, bytes(32))
                board.poke(18, struct.pack("<ff", y, x))
                cycles.append(board.call(symbols[f"fuzzy_float_{name}"].address, 2_000_000))
        figures.append(Figure(f"fuzzy: {text}, worst of 21 x 21", max(cycles), "cycles"))
    return figures


def _end(widths: tuple[int, ...], gain: float) -> int:
    """The size from which on every set of an input is constant, and with it u_fuzzy."""
    return min(LARGEST, int(max(abs(width) for width in widths) * SET_UNIT / max(gain, 1e-9)) + 2)


def _planes() -> list[Figure]:
    """Every point of the plane of e and ce for each set of the paper. Beyond the sets' last corner nothing changes, in
    either law, so the rectangle inside stands for the whole plane of 65,535 x 65,535 points."""
    joints: list[tuple[str, JointSettings]] = [("before tuning", load_joints(TABLES / "before_tuning.toml")[0])]
    for table in (10, 9):
        joints += [
            (f"Table {table}, joint {number}", joint)
            for number, joint in enumerate(load_joints(TABLES / f"table_{table}.toml"))
        ]
    figures = []
    for name, joint in joints:
        e = _end(joint.as_tuple()[:4], joint.kp)
        ce = _end(joint.as_tuple()[4:8], joint.kd * 20 / PERIOD_MS)
        worst = _native.fuzzy_worst_difference(joint.native(), PERIOD_MS, (-e, e), (-ce, ce))
        figures.append(at_most(f"fuzzy: largest error, {name}, whole plane", worst, "LSB q15", 1))
    return figures


def _least_exact() -> list[Figure]:
    """Climbs towards the largest error over parameters and inputs, against the rational reference."""

    def error(point: Point) -> float:
        ours = twin.infer(twin.compile_settings(point.settings, point.period_ms), [point.e], [point.ce]).u[0]
        law = exact.Law(point.settings, point.period_ms)
        u = law.infer(Fraction(point.e, 4096), Fraction(point.ce, 4096)).u
        return abs(float(ours - (1 << 15) * u))

    errors = climb(error, Random(3), 4_000, 300)
    return [at_most("fuzzy: largest error found over all parameters", max(errors), "LSB q15", 1)]
