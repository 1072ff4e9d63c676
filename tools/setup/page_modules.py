"""Compiles what a page runs to WebAssembly: the bench (sim), the tuner (host/native) and the rules of a calibration.

The same sources as for Python, by another compiler. No multiplication and addition may be fused, so that the arm moves
by the same bits as elsewhere.
"""

from __future__ import annotations

import shutil
from collections.abc import Iterator
from concurrent.futures import ThreadPoolExecutor
from dataclasses import dataclass
from pathlib import Path

from tools import ROOT
from tools.setup import stamps
from tools.setup.console import run, say
from tools.setup.goal import Goal

COMPILER = ("clang++", "--target=wasm32-wasi")
FLAGS = (
    *("-std=c++17", "-ffp-contract=off", "-fexceptions", "-Isim", "-Isim/arm", "-Ihost/native"),
    *("-Wall", "-Wextra", "-Wconversion", "-Werror"),
)
LINKER = "wasm-ld"  # as the compiler calls it
LINK = ("-mexec-model=reactor", "-Wl,--strip-all", "-Wl,-z,stack-size=65536")
# As core.cmake has them, for the vectors of WebAssembly.
KERNEL = ("-O2", "-fno-trapping-math", "-fno-exceptions", "-DGREYWHALE_INSTRUCTIONS=baseline")


@dataclass(frozen=True)
class Module:
    """A module, the files and folders that it is compiled from, and where their headers lie."""

    name: str
    places: tuple[str, ...]
    headers: tuple[str, ...]
    flags: tuple[str, ...]

    @property
    def path(self) -> Path:
        return ROOT / "build" / "web" / f"{self.name}.wasm"

    def files(self) -> Iterator[Path]:
        return (
            path for path in stamps.files_below(*self.places, *self.headers) if path.suffix in (".cpp", ".h", ".inc")
        )

    def sources(self) -> Iterator[Path]:
        return (path for path in stamps.files_below(*self.places) if path.suffix == ".cpp")


BENCH = Module("bench", ("sim/arm", "sim/bench", "sim/board", "sim/web"), (), ("-O2",))
TUNER = Module(
    "tuner",
    (
        "firmware/lib/fuzzy_pdi",
        "sim/arm",
        "sim/web/no_exceptions.cpp",
        *(f"host/native/{room}" for room in ("closed_loop", "score", "web")),
    ),
    ("firmware/lib", "host/native"),
    ("-Os", "-msimd128"),
)
CALIBRATION = Module("calibration", ("host/native/calibrate", "sim/web/no_exceptions.cpp"), (), ("-Os",))
MODULES = (BENCH, TUNER, CALIBRATION)


def step(goal: Goal) -> None:
    """Build what a page on any board needs, and for the site the bench and the tuner as well."""
    if goal < Goal.SITE and not all(map(shutil.which, (COMPILER[0], LINKER))):
        say(f"there is no {LINKER}: the page is built without its view Calibrate, which says so")
        return
    for module in MODULES if goal >= Goal.SITE else (CALIBRATION,):
        wanted = stamps.digest([*module.files(), Path(__file__)])
        if not (stamps.is_current(module.name, wanted) and module.path.is_file()):
            say(f"building the {module.name} for the page")
            _build(module)
            stamps.set_current(module.name, wanted)


def _build(module: Module) -> None:
    folder = module.path.parent / module.name
    folder.mkdir(parents=True, exist_ok=True)
    rooms = [f"-I{room / 'src'}" for room in sorted((ROOT / "firmware" / "lib").iterdir())]
    objects = {path: folder / f"{'.'.join(path.relative_to(ROOT).parts)}.o" for path in module.sources()}

    def compile_one(source: Path) -> None:
        flags = (*FLAGS, *module.flags, *(KERNEL if source.name == "kernel.cpp" else ()))
        command = [*COMPILER, *flags, *rooms, "-c", str(source), "-o", str(objects[source])]
        run(command, what=f"Compiling {source.name} for the page")

    with ThreadPoolExecutor() as pool:
        list(pool.map(compile_one, objects))
    made = ("-o", str(module.path))
    run([*COMPILER, *LINK, *map(str, objects.values()), *made], what=f"Linking the {module.name} for the page")
