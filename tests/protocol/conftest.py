"""Compiles the firmware's link and params code for this computer, so that the tests can ask both sides alike."""

from __future__ import annotations

import ctypes
import subprocess
from pathlib import Path

import pytest

from tools import ROOT

_SOURCES = [
    "firmware/lib/link/src/link/frame.cpp",
    "firmware/lib/params/src/params/params.cpp",
    "firmware/lib/params/src/params/table.cpp",
]
_INCLUDES = [*(f"firmware/lib/{room}/src" for room in ("codes", "link", "params")), "firmware/test/native"]


class Firmware:
    """The C interface of firmware.cpp in Python's types."""

    def __init__(self, library: Path) -> None:
        self._c = ctypes.CDLL(str(library))
        self._c.gw_schema_hash.restype = ctypes.c_uint32
        self._c.gw_crc.restype = ctypes.c_uint16
        self.schema_hash = int(self._c.gw_schema_hash())
        self.table_size = int(self._c.gw_table_size())

    def encode(self, type: int, seq: int, payload: bytes) -> bytes:
        out = ctypes.create_string_buffer(64)
        size = self._c.gw_encode(type, seq, payload, len(payload), out)
        return out.raw[:size]

    def decode(self, stream: bytes) -> tuple[list[tuple[int, int, bytes]], int]:
        """The frames of a stream and the count of bad ones."""
        out = ctypes.create_string_buffer(len(stream) + 64)
        bad = ctypes.c_uint16()
        used = self._c.gw_decode(stream, len(stream), out, ctypes.byref(bad))
        data = out.raw[:used]
        frames = []
        while data:
            size = data[2]
            frames.append((data[0], data[1], data[3 : 3 + size]))
            data = data[3 + size :]
        return frames, bad.value

    def reencode(self, name: str, payload: bytes) -> bytes | None:
        """The payload after a passage through the firmware's struct; None when its length is refused."""
        out = ctypes.create_string_buffer(64)
        size = self._c.gw_reencode(name.encode(), payload, len(payload), out)
        assert size != -2, f"the firmware has no message {name}"
        return None if size < 0 else out.raw[:size]

    def defaults(self) -> bytearray:
        table = bytearray(self.table_size)
        self._c.gw_defaults(self._pointer(table))
        return table

    def set(self, table: bytearray, index: int, value: int) -> str:
        return ("ok", "bad_index", "out_of_range")[self._c.gw_set(self._pointer(table), index, value)]

    def get(self, table: bytearray, index: int) -> int | None:
        value = ctypes.c_int32()
        result = self._c.gw_get(self._pointer(table), index, ctypes.byref(value))
        return None if result else value.value

    def crc(self, table: bytearray) -> int:
        return int(self._c.gw_crc(self._pointer(table)))

    def first_invalid(self, table: bytearray) -> int | None:
        index = int(self._c.gw_first_invalid(self._pointer(table)))
        return None if index == 255 else index

    @staticmethod
    def _pointer(table: bytearray) -> ctypes.Array[ctypes.c_char]:
        return (ctypes.c_char * len(table)).from_buffer(table)


@pytest.fixture(scope="session")
def firmware(tmp_path_factory: pytest.TempPathFactory) -> Firmware:
    library = tmp_path_factory.mktemp("firmware") / "firmware.so"
    sources = [*(ROOT / path for path in _SOURCES), Path(__file__).with_name("firmware.cpp")]
    flags = ["-std=gnu++14", "-O1", "-shared", "-fPIC", "-Wall", "-Wextra", "-Wconversion", "-Werror"]
    includes = [f"-I{ROOT / path}" for path in _INCLUDES]
    subprocess.run(["g++", *flags, *includes, "-o", library, *sources], check=True)
    return Firmware(library)
