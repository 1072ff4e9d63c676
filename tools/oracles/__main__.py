"""Installs what tests/oracles compares with: other people's packages and simulators, other processors."""

from __future__ import annotations

import sys

from tools import ROOT
from tools.oracles import lerobot, node, wheelhouse
from tools.setup import stamps, system, venv
from tools.setup.console import SetupError, say

DEBIAN = (
    "libsimavr-dev",  # another CPU for the simulated board
    "csmith",  # programs for it that nobody here wrote
    "libcsmith-dev",
    "avrdude",  # the flasher that others use
    "octave",  # the fuzzy law as others evaluate it
    "octave-fuzzy-logic-toolkit",
    "gcc-arm-none-eabi",  # the controller core on a 32-bit chip
    "libnewlib-arm-none-eabi",
    "libstdc++-arm-none-eabi-newlib",
    "qemu-system-arm",
    "g++-aarch64-linux-gnu",  # the native code on 64-bit ARM
    "qemu-user",
    "arduino-builder",  # the examples of the library as the Arduino IDE compiles them
    "arduino-core-avr",
    "openssl",  # certificates for a scheduler of studies
)
REQUIREMENTS = ROOT / "tools" / "oracles" / "requirements.txt"


def main() -> int:
    try:
        system.ensure(DEBIAN)
        wanted = stamps.digest([REQUIREMENTS])
        if not stamps.is_current("oracles", wanted):
            say("installing the outside references (some hundred megabytes)")
            # Without their dependencies: all of them are in this file or in the project's own.
            venv.pip_install("--no-deps", "--requirement", REQUIREMENTS, what="Installing them")
            stamps.set_current("oracles", wanted)
        wheelhouse.step()
        node.step()
        lerobot.step()
    except SetupError as error:
        print(f"set-up: {error}", file=sys.stderr)
        return 1
    return 0


if __name__ == "__main__":
    sys.exit(main())
