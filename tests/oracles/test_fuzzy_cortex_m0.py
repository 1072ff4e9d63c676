"""The core on a 32-bit Cortex-M0, under qemu, gives the bits of this machine and of the AVR."""

from __future__ import annotations

import struct
import subprocess
from pathlib import Path

import numpy as np

from tools.support.fuzzy_search import Random

SOURCES = Path(__file__).parents[2] / "firmware/lib/fuzzy_pdi/src"
INCLUDES = [f"-I{SOURCES}", f"-I{SOURCES.parents[1]}/codes/src"]
DRIVER = Path(__file__).with_name("fuzzy_cortex_m0.cpp")
FLAGS = [
    "-mcpu=cortex-m0",
    "-mthumb",
    "-O2",
    "-std=c++14",
    "-Wall",
    "-Wextra",
    "-Wconversion",
    "-Werror",
    "-fno-exceptions",
]
LINKING = ["--specs=rdimon.specs", "-nostartfiles", "-Wl,-T," + str(Path(__file__).with_name("cortex_m0.ld"))]
QEMU = [
    "qemu-system-arm",
    "-M",
    "microbit",
    "-nographic",
    "-monitor",
    "none",
    "-serial",
    "none",
    "-semihosting",
    "-kernel",
]
SETTINGS = struct.Struct("<8h3IHBB")
RESULT = struct.Struct("<hhBiH")
CONTROLLERS, PERIODS = 200, 100


def test_same_bits(tmp_path: Path) -> None:
    random = Random(5)
    packed, expected = [struct.pack("<H", CONTROLLERS)], b""
    for _ in range(CONTROLLERS):
        point = random.point()
        native = point.settings.controller(point.period_ms)
        places = np.array([random.place(point.settings, point.period_ms) for _ in range(PERIODS)])
        leader = np.clip(places[:, 0], -32768, 32767).astype(np.int16)
        follower = np.clip(places[:, 1], -32768, 32767).astype(np.int16)
        limit = random.random.integers(0, 32768, PERIODS).astype(np.uint16)
        packed.append(SETTINGS.pack(*point.settings.as_tuple(), point.period_ms) + struct.pack("<H", PERIODS))
        packed += [struct.pack("<hhH", *row) for row in zip(leader, follower, limit, strict=True)]
        run = native.run(leader, follower, limit)
        flags = run["saturated"].astype(int) | run["no_rule"].astype(int) << 1
        rows = zip(run["u_fuzzy"], run["volts_mv"], flags, run["integral"], run["fraction"], strict=True)
        expected += b"\0" + b"".join(RESULT.pack(*(int(value) for value in row)) for row in rows)

    elf = tmp_path / "core.elf"
    sources = [str(DRIVER), *map(str, sorted(SOURCES.glob("*.cpp")))]
    command = ["arm-none-eabi-g++", *FLAGS, *LINKING, *INCLUDES, *sources, "-o", str(elf)]
    subprocess.run(command, check=True)
    (tmp_path / "vectors.bin").write_bytes(b"".join(packed))
    subprocess.run([*QEMU, str(elf)], check=True, cwd=tmp_path, timeout=300)
    assert (tmp_path / "results.bin").read_bytes() == expected
