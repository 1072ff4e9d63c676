"""`python -m greywhale_sim`: a bench behind a serial port; the first line printed is the port."""

import sys

if __name__ == "__main__" and not sys.flags.safe_path:
    del sys.path[0]  # `python -m` looks in the current folder first, and would run a `json.py` that lies there

import argparse
import json
from pathlib import Path

from greywhale.errors import UserError
from greywhale_sim.drivers import CHIPS
from greywhale_sim.mistakes import listed
from greywhale_sim.serve import ServeOptions, serve
from greywhale_sim.wiring import BOARDS


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


def main() -> int:
    arguments = vars(parser().parse_args())
    as_json, mistakes = arguments.pop("json"), tuple(arguments.pop("mistake"))
    if "list" in mistakes:
        print(listed())
        return 0

    def ready(port: str) -> None:
        print(json.dumps({"port": port}) if as_json else port, flush=True)

    def note(text: str) -> None:
        print(f"greywhale_sim: {text}", file=sys.stderr, flush=True)

    try:
        serve(ServeOptions(**arguments, mistakes=mistakes), ready, note=note)
    except UserError as error:
        print(f"greywhale_sim: {error.message}", file=sys.stderr)
        return error.exit_code
    except KeyboardInterrupt:  # before the bench was up
        return 130
    return 0


if __name__ == "__main__":
    sys.exit(main())
