"""What a user installs with pip is whole: in an empty environment without compiler, PlatformIO and checkout, it works.

The wheels are built from the source distributions, as a stranger's pip would do it, and nothing is fetched. Where they
are for the stable ABI, they are installed into the Pythons that GREYWHALE_OTHER_PYTHONS names as well.
"""

from __future__ import annotations

import json
import os
import shutil
import signal
import subprocess
import sys
import tarfile
import urllib.request
import zipfile
from dataclasses import dataclass
from pathlib import Path

import pytest

from greywhale.board.flash.targets import BOARDS
from greywhale.cli.story import BenchProcess
from tools import ROOT, dist
from tools.oracles import wheelhouse
from tools.setup import platformio

OWN = Path(sys.executable)
PYTHONS = [OWN, *(Path(python) for python in os.environ.get("GREYWHALE_OTHER_PYTHONS", "").split(os.pathsep) if python)]
CONTROLLERS = {"before_tuning", "table_8", "table_9", "table_10"}
pytestmark = pytest.mark.timeout(1200)  # of which building the extensions takes the most


@dataclass(frozen=True)
class Installation:
    """An environment with greywhale in it, away from everything else: no other program is on the PATH."""

    folder: Path

    @property
    def package(self) -> Path:
        (found,) = self.folder.glob("lib/python*/site-packages/greywhale")
        return found

    def run(self, *command: str, cwd: Path | None = None) -> subprocess.CompletedProcess[str]:
        """Run a program of the environment."""
        environment = {"PATH": str(self.folder / "bin"), "HOME": str(self.folder)}
        program = str(self.folder / "bin" / command[0])
        return subprocess.run(
            [program, *command[1:]],
            cwd=cwd or self.folder,
            env=environment,
            capture_output=True,
            text=True,
            timeout=120,
            check=False,
        )

    def ask(self, *arguments: str) -> dict[str, object]:
        """The JSON of a verb that must succeed."""
        answer = self.run("greywhale", *arguments, "--json")
        assert answer.returncode == 0, answer.stdout + answer.stderr
        facts: dict[str, object] = json.loads(answer.stdout)
        return facts


@pytest.fixture(scope="session")
def built(tmp_path_factory: pytest.TempPathFactory) -> list[Path]:
    """The source distributions and wheels of both packages."""
    return dist.build_all(tmp_path_factory.mktemp("dist"), [dist.venv.PYTHON])


@pytest.fixture(scope="session")
def wheels(built: list[Path]) -> tuple[Path, Path]:
    greywhale, bench = sorted(path for path in built if path.suffix == ".whl")
    return greywhale, bench


def install(folder: Path, *wheels: Path, python: Path = OWN) -> Installation:
    """A new environment with these wheels and what they depend on."""
    subprocess.run([python, "-m", "venv", "--without-pip", folder / "env"], check=True)
    pip = [sys.executable, "-m", "pip", "--python", folder / "env/bin/python", "--disable-pip-version-check"]
    found = wheelhouse.place(python)
    offline = ["--no-index", "--find-links", found, "--no-compile"]  # a module is compiled when it is imported
    subprocess.run([*pip, "install", "--quiet", *offline, *wheels], check=True)
    return Installation(folder / "env")


@pytest.fixture(scope="session")
def alone(wheels: tuple[Path, Path], tmp_path_factory: pytest.TempPathFactory) -> Installation:
    """greywhale without the bench."""
    return install(tmp_path_factory.mktemp("alone"), wheels[0])


@pytest.fixture(scope="session", params=PYTHONS, ids=lambda python: python.parents[1].name)
def with_bench(
    wheels: tuple[Path, Path], request: pytest.FixtureRequest, tmp_path_factory: pytest.TempPathFactory
) -> Installation:
    wheelhouse.step(request.param)
    return install(tmp_path_factory.mktemp("with-bench"), *wheels, python=request.param)


def names_in(archive: Path) -> set[str]:
    """Files of a wheel; of a source distribution without its outermost folder."""
    if archive.suffix == ".whl":
        with zipfile.ZipFile(archive) as wheel:
            return {name for name in wheel.namelist() if not name.endswith("/")}
    with tarfile.open(archive) as sources:
        return {name.partition("/")[2] for name in sources.getnames()}


def read(wheel: Path, ending: str) -> str:
    """The one file of a wheel whose name ends so."""
    with zipfile.ZipFile(wheel) as archive:
        (name,) = (name for name in archive.namelist() if name.endswith(ending))
        return archive.read(name).decode()


def test_the_wheel_holds_code_firmware_and_controllers_and_nothing_else(wheels: tuple[Path, Path]) -> None:
    names = names_in(wheels[0])
    data = {name.removeprefix("greywhale/data/") for name in names if name.startswith("greywhale/data/")}
    assert data == {"firmware/mega.hex", "firmware/nano.hex", *(f"fuzzy_tables/{name}.toml" for name in CONTROLLERS)}
    assert len([name for name in names if name.startswith("greywhale/_native.") and name.endswith(".so")]) == 1
    assert {"greywhale/_native.pyi", "greywhale/py.typed", "greywhale/cli/flash.py"} <= names
    assert {f"greywhale/dashboard/page/{name}" for name in ("index.html", "page.js", "page.css")} <= names
    assert {Path(name).parts[0].split("-")[0] for name in names} == {"greywhale"}
    assert not [name for name in names if "test" in name or "greywhale_sim" in name]
    licences = {Path(name).name for name in names if "/licenses/" in name}
    assert licences == {"LICENSE", "NOTICE"}
    assert "Apache License" in read(wheels[0], "/LICENSE")
    assert "License-Expression: Apache-2.0" in read(wheels[0], "/METADATA")


def test_the_bench_is_a_wheel_of_its_own_and_needs_no_library(wheels: tuple[Path, Path]) -> None:
    names = names_in(wheels[1])
    assert {Path(name).parts[0].split("-")[0].split(".")[0] for name in names} == {"greywhale_sim"}
    assert {"greywhale_sim/bootloaders/mega.hex", "greywhale_sim/bootloaders/nano.hex"} <= names
    assert not [name for name in names if name.startswith("greywhale_sim.libs/")]
    assert "License-Expression: GPL-3.0-or-later" in read(wheels[1], "/METADATA")


def test_tags_say_for_which_python_and_which_linux_a_wheel_is(wheels: tuple[Path, Path]) -> None:
    minor = sys.version_info.minor
    python = "cp312-abi3" if minor >= 12 else f"cp3{minor}-cp3{minor}"
    extension = ".abi3.so" if minor >= 12 else f".cpython-3{minor}-x86_64-linux-gnu.so"
    for wheel, module in zip(wheels, ("greywhale/_native", "greywhale_sim/_board"), strict=True):
        assert f"-{python}-manylinux_2_" in wheel.name
        assert f"{module}{extension}" in names_in(wheel)


def test_the_sources_hold_both_images_and_the_bench_no_sources_of_the_arm(built: list[Path]) -> None:
    greywhale, bench = sorted(path for path in built if path.name.endswith(".tar.gz"))
    names = names_in(greywhale)
    assert {f"firmware/.pio/build/{board.environment}/firmware.hex" for board in BOARDS.values()} <= names
    assert {"firmware/src/main.cpp", "firmware/platformio.ini", "sim/arm/step.h", "pyproject.toml"} <= names
    assert not [name for name in names if name.startswith("tests/")]
    assert {name.split("/")[1] for name in names if name.startswith("sim/")} == {"arm"}
    names = names_in(bench)
    assert {"bootloaders/mega/stk500boot.c", "bootloaders/nano/ATmegaBOOT_168.c", "board/board.cpp"} <= names
    assert not [name for name in names if name.startswith("arm/")]


def test_the_images_are_those_of_this_source_byte_for_byte(alone: Installation, tmp_path: Path) -> None:
    firmware = tmp_path / "somewhere" / "else"
    shutil.copytree(ROOT / "firmware", firmware, ignore=shutil.ignore_patterns(".pio", "test"))
    environments = [word for board in BOARDS.values() for word in ("--environment", board.environment)]
    command = [sys.executable, "-m", "platformio", "run", "--project-dir", str(firmware), *environments]
    subprocess.run(command, env=platformio.full_environment(), check=True, capture_output=True)
    for name, board in BOARDS.items():
        fresh = firmware / ".pio" / "build" / board.environment / "firmware.hex"
        assert (alone.package / "data" / "firmware" / f"{name}.hex").read_bytes() == fresh.read_bytes()


def test_no_wheel_is_built_with_an_image_of_other_sources(built: list[Path], tmp_path: Path) -> None:
    sdist, _ = sorted(path for path in built if path.name.endswith(".tar.gz"))
    with tarfile.open(sdist) as archive:
        archive.extractall(tmp_path, filter="data")
    (folder,) = tmp_path.iterdir()
    with (folder / "firmware" / "src" / "main.cpp").open("a") as source:
        source.write("\n")
    pip = [sys.executable, "-m", "pip", "wheel", "--disable-pip-version-check", "--no-deps", "--no-build-isolation"]
    answer = subprocess.run(
        [*pip, "--wheel-dir", str(tmp_path / "out"), str(folder)], capture_output=True, text=True, check=False
    )
    assert answer.returncode != 0
    assert "was built from other sources; run `make firmware`" in " ".join((answer.stdout + answer.stderr).split())
    assert not (tmp_path / "out").exists() or not list((tmp_path / "out").iterdir())


def test_the_package_itself_runs_and_not_the_checkout(alone: Installation) -> None:
    code = "import greywhale, greywhale._native as n; print(greywhale.__file__, n.__file__, greywhale.__version__)"
    package, native, version = alone.run("python", "-c", code).stdout.split()
    assert Path(package).parent == Path(native).parent == alone.package
    assert alone.run("greywhale", "--version").stdout == f"greywhale, version {version}\n"
    assert alone.run("python", "-c", "import platformio").returncode == 1


@pytest.mark.parametrize("board", BOARDS)
def test_a_board_is_flashed_tuned_and_recorded(alone: Installation, board: str, tmp_path: Path) -> None:
    """The board is simulated by the checkout, in a process of its own."""
    with BenchProcess("--board", board, "--blank", "--speed", "max") as bench:
        version = alone.run("greywhale", "--version").stdout.split()[-1]
        flashed = alone.ask("flash", "--port", bench.port)
        assert flashed["firmware"] == version
        assert alone.ask("info", "--port", bench.port)["board"] == BOARDS[board].identity.key
        table = alone.package / "data" / "fuzzy_tables" / "table_8.toml"
        alone.ask("upload", "--port", bench.port, str(table))
        log = tmp_path / "log.csv"
        alone.ask("record", "--port", bench.port, "--enable", "--seconds", "2", "--out", str(log))
        assert len(log.read_text().splitlines()) > 2000
        alone.ask("evaluate", str(log))


def test_the_whole_story_runs_in_an_empty_environment(with_bench: Installation, tmp_path: Path) -> None:
    """The demo flashes its board, practises, identifies and tunes; the verbs do it again from its recordings."""
    out = tmp_path / "out"
    facts = with_bench.ask("demo", "--duration", "4", "--practice", "10", "--budget", "20", "--out", str(out))
    assert facts["board"] == "mega2560"
    assert (out / "following.png").stat().st_size > 10_000
    model, controller = tmp_path / "model.toml", tmp_path / "controller.toml"
    with_bench.ask("identify", str(out / "practice.csv"), "--validate", str(out / "before.csv"), "--out", str(model))
    with_bench.ask("tune", str(model), "--budget", "20", "--out", str(controller))
    assert "joint" in controller.read_text(encoding="utf-8")


def test_the_page_is_served_with_a_bench(with_bench: Installation, tmp_path: Path) -> None:
    command = [with_bench.folder / "bin" / "greywhale", "dashboard", "--sim", "--no-browser"]
    environment = {"PATH": str(with_bench.folder / "bin"), "HOME": str(tmp_path), "PYTHONUNBUFFERED": "1"}
    server = subprocess.Popen(command, cwd=tmp_path, env=environment, stdout=subprocess.PIPE, text=True)
    try:
        assert server.stdout is not None
        address = next(word for line in server.stdout for word in line.split() if word.startswith("http://"))
        with urllib.request.urlopen(address, timeout=60) as answer:
            assert "<title>greywhale" in answer.read().decode()
    finally:
        server.send_signal(signal.SIGINT)
        server.wait(60)
