"""Compiles the bench inside a page, firmware/lib and sim/arm with sim/web, to WebAssembly: build/web/bench.wasm.

The same sources as for the board and for the simulation, by another compiler. No multiplication and addition may be
fused, so that the arm moves by the same bits as elsewhere.
"""

from __future__ import annotations

from concurrent.futures import ThreadPoolExecutor
from pathlib import Path

from tools import ROOT
from tools.setup import stamps
from tools.setup.console import run, say

MODULE = ROOT / "build" / "web" / "bench.wasm"
SOURCES = ("firmware/lib", "sim/arm", "sim/web")
COMPILER = ("clang++", "--target=wasm32-wasi")
FLAGS = (
    *("-std=c++17", "-O2", "-ffp-contract=off", "-fexceptions", "-Isim"),
    *("-Wall", "-Wextra", "-Wconversion", "-Werror"),
)
LINK = ("-mexec-model=reactor", "-Wl,--strip-all", "-Wl,-z,stack-size=65536")


def compiled(path: Path) -> bool:
    """Whether a source is for the page: of the hardware's implementations, its own alone."""
    return path.suffix == ".cpp" and (path.parent.name == "web" or "hal" not in path.parts)


def step() -> None:
    files = stamps.files_below(*SOURCES)
    wanted = stamps.digest([*files, Path(__file__)])
    if stamps.is_current("bench_module", wanted) and MODULE.is_file():
        return
    say("building the bench for the page")
    MODULE.parent.mkdir(parents=True, exist_ok=True)
    rooms = [f"-I{room / 'src'}" for room in sorted((ROOT / "firmware" / "lib").iterdir())]
    sources = [path for path in files if compiled(path)]
    objects = [MODULE.parent / f"{'.'.join(path.relative_to(ROOT).parts)}.o" for path in sources]

    def compile_one(source: Path, made: Path) -> None:
        command = [*COMPILER, *FLAGS, *rooms, "-c", str(source), "-o", str(made)]
        run(command, what=f"Compiling {source.name} for the page")

    with ThreadPoolExecutor() as pool:
        list(pool.map(compile_one, sources, objects))
    run([*COMPILER, *LINK, *map(str, objects), "-o", str(MODULE)], what="Linking the bench for the page")
    stamps.set_current("bench_module", wanted)
