"""The words that start a bench, of `python -m greywhale_sim` and of a bench in this process."""

from __future__ import annotations

import argparse
from collections.abc import Sequence
from pathlib import Path

from greywhale_sim.drivers import CHIPS
from greywhale_sim.lockstep import LockStepBench
from greywhale_sim.serve import ServeOptions
from greywhale_sim.wiring import BOARDS


def read(words: Sequence[str] | None = None) -> tuple[ServeOptions, bool]:
    """The options that these words name, those of the command line by default, and whether the answer is JSON."""
    given = vars(parser().parse_args(words))
    as_json, faults = given.pop("json"), tuple(given.pop("mistake"))
    return ServeOptions(**given, faults=faults), as_json


def lock_step(*words: str) -> LockStepBench:
    """A bench in this process that these words describe; its speed is that of whoever reads."""
    return LockStepBench(read(words)[0])


def parser() -> argparse.ArgumentParser:
    text = argparse.ArgumentParser(
        prog="python -m greywhale_sim", description="A simulated bench behind a serial port."
    )
    text.add_argument("--board", choices=sorted(BOARDS), default="mega", help="which Arduino (default: mega)")
    text.add_argument(
        "--leader", type=Path, metavar="FILE.csv", help="the leader's motion (default: generated reaches)"
    )
    text.add_argument("--arm", type=Path, metavar="FILE.toml", help="the follower arm (default: the built-in one)")
    text.add_argument("--driver", choices=list(CHIPS), default="drv8838", help="the motor drivers' chip")
    text.add_argument("--speed", choices=("1", "max"), default="1", help="real time, or as fast as possible")
    text.add_argument(
        "--firmware",
        type=Path,
        metavar="FILE.hex",
        help="firmware to start with (default: the last build, or what came with greywhale)",
    )
    text.add_argument("--blank", action="store_true", help="start with nothing but the bootloader")
    text.add_argument("--eeprom", type=Path, metavar="FILE", help="keep the EEPROM in this file")
    text.add_argument("--seed", type=int, default=1, help="of everything random (default: 1)")
    text.add_argument(
        "--mistake", action="append", default=[], metavar="NAME", help="wire it wrongly; `--mistake list` names all"
    )
    text.add_argument("--link", type=Path, metavar="PATH", help="a lasting name for the port")
    text.add_argument(
        "--control", action="store_true", help="take commands from standard input; its end ends the bench"
    )
    text.add_argument("--json", action="store_true", help='print {"port": ...} instead of the bare port')
    return text
