"""A pip installation is whole: in an empty environment without compiler, PlatformIO and checkout, it works.

The wheels are built from the source distributions, as a stranger's pip would do it, and nothing is fetched. What was
compiled from the same files before is not compiled again. Where greywhale's is for the stable ABI, it is installed into
the Pythons that GREYWHALE_OTHER_PYTHONS names as well.
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
from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path

import pytest

from greywhale.board.flash.rules import BOARDS
from greywhale.cli.story import BenchProcess
from greywhale.files.model import arm_toml
from tests.support.arms import with_joints
from tools import ROOT, dist
from tools.oracles import wheelhouse
from tools.setup import platformio

OWN = Path(sys.executable)
KEPT = ROOT / "build" / "oracles" / "wheel"  # greywhale's sources as distributed, and what was compiled from them
PYTHONS = [OWN, *(Path(python) for python in os.environ.get("GREYWHALE_OTHER_PYTHONS", "").split(os.pathsep) if python)]
CONTROLLERS = {"before_tuning", "table_8", "table_9", "table_10"}
# An empty report, as page and as PDF.
WRITE = """
from pathlib import Path
from greywhale_paper.pages.document import Document
from greywhale_paper.render.html import write_html
from greywhale_paper.render.pdf import write_pdf
made = Document("The paper", ("Nothing is in it.",), ())
write_html(made, Path("report.html"))
write_pdf(made, Path("report.pdf"))
"""
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
def built(tmp_path_factory: pytest.TempPathFactory) -> tuple[Path, Path]:
    """The source distribution and the wheel."""
    out, sources, compiled = tmp_path_factory.mktemp("dist"), KEPT / "sources", KEPT / "compiled"
    sdist = dist.build_sdist("greywhale", ROOT, out)
    unpack(sdist, sources)
    (compiled / "CMakeCache.txt").unlink(missing_ok=True)  # no option is one of an earlier build
    return sdist, dist.build_wheel(sources, out, kept=compiled)


def unpack(sdist: Path, folder: Path) -> None:
    """Its files and no other; one that is the same keeps its time, so that nothing is compiled again for it."""
    with tarfile.open(sdist) as archive:
        files = {
            folder / one.name.partition("/")[2]: archive.extractfile(one).read() for one in archive if one.isfile()
        }
    for path in folder.rglob("*"):
        if path.is_file() and path not in files:
            path.unlink()
    for path, data in files.items():
        if not path.is_file() or path.read_bytes() != data:
            path.parent.mkdir(parents=True, exist_ok=True)
            path.write_bytes(data)


@pytest.fixture(scope="session")
def paper(tmp_path_factory: pytest.TempPathFactory) -> tuple[Path, Path]:
    """Those of greywhale-paper."""
    sdist, wheel = dist.build_paper(tmp_path_factory.mktemp("paper"))
    return sdist, wheel


def install(folder: Path, wheels: Sequence[Path], python: Path = OWN) -> Installation:
    """A new environment with the wheels and what they depend on."""
    subprocess.run([python, "-m", "venv", "--without-pip", folder / "env"], check=True)
    pip = [sys.executable, "-m", "pip", "--python", folder / "env/bin/python", "--disable-pip-version-check"]
    found = wheelhouse.place(python)
    offline = ["--no-index", "--find-links", found, "--no-compile"]  # a module is compiled when it is imported
    subprocess.run([*pip, "install", "--quiet", *offline, *wheels], check=True)
    return Installation(folder / "env")


@pytest.fixture(scope="session", params=PYTHONS, ids=lambda python: python.parents[1].name)
def installed(
    built: tuple[Path, Path], request: pytest.FixtureRequest, tmp_path_factory: pytest.TempPathFactory
) -> Installation:
    wheelhouse.step(request.param)
    return install(tmp_path_factory.mktemp("installed"), [built[1]], request.param)


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


def test_the_wheel_holds_code_firmware_bench_and_controllers_and_nothing_else(built: tuple[Path, Path]) -> None:
    _, wheel = built
    names = names_in(wheel)
    data = {name.removeprefix("greywhale/data/") for name in names if name.startswith("greywhale/data/")}
    assert data == {"firmware/mega.hex", "firmware/nano.hex", *(f"fuzzy_tables/{name}.toml" for name in CONTROLLERS)}
    assert len([name for name in names if name.endswith(".so")]) == 1
    assert {"greywhale/_native.pyi"} == {name for name in names if name.endswith(".pyi")}
    assert {"greywhale/py.typed", "greywhale/cli/flash.py", "greywhale_sim/serve.py"} <= names
    page = ("index.html", "page.js", "page.css", "calibration.wasm")
    assert {f"greywhale/dashboard/page/{name}" for name in page} <= names
    assert {"greywhale_sim/bootloaders/mega.hex", "greywhale_sim/bootloaders/nano.hex"} <= names
    assert {Path(name).parts[0].split("-")[0] for name in names} == {"greywhale", "greywhale_sim"}  # and no library
    assert not [name for name in names if "test" in name]


def test_the_wheel_says_its_licences(built: tuple[Path, Path]) -> None:
    _, wheel = built
    licences = {name.partition("/licenses/")[2] for name in names_in(wheel) if "/licenses/" in name}
    assert licences == {"LICENSE", "LICENSES/GPL-2.0-or-later.txt", "NOTICE"}
    assert "Apache License" in read(wheel, "/licenses/LICENSE")
    assert "License-Expression: Apache-2.0 AND GPL-2.0-or-later" in read(wheel, "/METADATA")


def test_the_papers_wheel_is_for_all_and_holds_its_code_and_its_licence_and_nothing_else(
    built: tuple[Path, Path], paper: tuple[Path, Path]
) -> None:
    _, wheel = paper
    names = names_in(wheel)
    source = ROOT / "studies" / "paper"
    code = {str(path.relative_to(source)) for path in source.glob("greywhale_paper/**/*") if path.is_file()}
    assert {name for name in names if ".dist-info/" not in name} == {name for name in code if "__pycache__" not in name}
    assert wheel.name.endswith("-py3-none-any.whl")
    assert read(wheel, "/licenses/LICENSE") == (ROOT / "LICENSE").read_text(encoding="utf-8")
    facts, greywhales = read(wheel, "/METADATA"), read(built[1], "/METADATA")
    assert "License-Expression: Apache-2.0\n" in facts
    assert "Requires-Dist: reportlab" in facts
    assert "reportlab" not in greywhales


def test_the_papers_sources_hold_the_licence_itself(paper: tuple[Path, Path]) -> None:
    """And no link to where it is in this repository."""
    with tarfile.open(paper[0]) as sources:
        (licence,) = (one for one in sources.getmembers() if one.name.endswith("/LICENSE"))
        assert licence.isfile()
        assert licence.size == (ROOT / "LICENSE").stat().st_size


def test_the_papers_verbs_are_there_once_its_wheel_is(
    installed: Installation, built: tuple[Path, Path], paper: tuple[Path, Path], tmp_path: Path
) -> None:
    both = install(tmp_path, [built[1], paper[1]])
    compare = ("compare", "--functions", "sphere", "--methods", "de", "--budget", "20", "--seeds", "1")
    refused = installed.run("greywhale", *compare)
    assert refused.returncode == 1
    assert "install it: pip install greywhale-paper." in " ".join(refused.stderr.split())
    assert "reproduce" not in installed.run("greywhale", "--help").stdout
    assert both.ask(*compare)["seeds"] == 1
    assert "  reproduce " in both.run("greywhale", "--help").stdout
    assert both.run("greywhale", "reproduce", "--help").returncode == 0
    written = both.run("python", "-c", WRITE)
    assert written.returncode == 0, written.stderr
    assert (both.folder / "report.pdf").read_bytes().startswith(b"%PDF")


def test_tags_say_for_which_python_and_which_linux_a_wheel_is(built: tuple[Path, Path]) -> None:
    minor = sys.version_info.minor
    python = "cp312-abi3" if minor >= 12 else f"cp3{minor}-cp3{minor}"
    extension = ".abi3.so" if minor >= 12 else f".cpython-3{minor}-x86_64-linux-gnu.so"
    assert f"-{python}-manylinux_2_" in built[1].name
    assert f"greywhale/_native{extension}" in names_in(built[1])


def test_the_sources_hold_both_images_and_the_sources_of_both_bootloaders(built: tuple[Path, Path]) -> None:
    names = names_in(built[0])
    assert {f"firmware/.pio/build/{board.environment}/firmware.hex" for board in BOARDS.values()} <= names
    assert {"firmware/src/main.cpp", "firmware/platformio.ini", "sim/arm/step.h", "pyproject.toml"} <= names
    assert {f"sim/bootloaders/{name}" for name in ("mega/stk500boot.c", "nano/ATmegaBOOT_168.c")} <= names
    assert not [name for name in names if name.startswith("tests/")]
    assert {name.split("/")[1] for name in names if name.startswith("sim/")} == {
        *("arm", "bench", "bench.cmake", "bind", "board", "bootloaders"),
    }


def test_the_images_are_those_of_this_source_byte_for_byte(installed: Installation, tmp_path: Path) -> None:
    firmware = tmp_path / "somewhere" / "else"
    shutil.copytree(ROOT / "firmware", firmware, ignore=shutil.ignore_patterns(".pio", "test"))
    environments = [word for board in BOARDS.values() for word in ("--environment", board.environment)]
    command = [sys.executable, "-m", "platformio", "run", "--project-dir", str(firmware), *environments]
    subprocess.run(command, env=platformio.full_environment(), check=True, capture_output=True)
    for name, board in BOARDS.items():
        fresh = firmware / ".pio" / "build" / board.environment / "firmware.hex"
        assert (installed.package / "data" / "firmware" / f"{name}.hex").read_bytes() == fresh.read_bytes()


def test_no_wheel_is_built_with_an_image_of_other_sources(built: tuple[Path, Path], tmp_path: Path) -> None:
    with tarfile.open(built[0]) as archive:
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


def test_the_package_itself_runs_and_not_the_checkout(installed: Installation) -> None:
    code = "import greywhale, greywhale._native as n; print(greywhale.__file__, n.__file__, greywhale.__version__)"
    package, native, version = installed.run("python", "-c", code).stdout.split()
    assert Path(package).parent == Path(native).parent == installed.package
    assert installed.run("greywhale", "--version").stdout == f"greywhale, version {version}\n"
    assert installed.run("python", "-c", "import platformio").returncode == 1


@pytest.mark.parametrize("board", BOARDS)
def test_a_board_is_flashed_tuned_and_recorded(installed: Installation, board: str, tmp_path: Path) -> None:
    """The board is simulated by the checkout, in a process of its own."""
    with BenchProcess("--board", board, "--blank", "--speed", "max") as bench:
        version = installed.run("greywhale", "--version").stdout.split()[-1]
        flashed = installed.ask("flash", "--port", bench.port)
        assert flashed["firmware"] == version
        assert installed.ask("info", "--port", bench.port)["board"] == BOARDS[board].identity.key
        table = installed.package / "data" / "fuzzy_tables" / "table_8.toml"
        installed.ask("upload", "--port", bench.port, str(table))
        log = tmp_path / "log.csv"
        installed.ask("record", "--port", bench.port, "--enable", "--seconds", "2", "--out", str(log))
        assert len(log.read_text().splitlines()) > 2000
        installed.ask("evaluate", str(log))


def test_the_whole_story_runs_in_an_empty_environment(installed: Installation, tmp_path: Path) -> None:
    """The demo flashes its board and shows two sets; the verbs identify and tune from its recordings.

    Of one joint: three more would run the same code.
    """
    arm, white_box, out = tmp_path / "arm.toml", tmp_path / "white_box.toml", tmp_path / "out"
    arm.write_text(arm_toml(with_joints((0,)), "One joint."))
    white_box.write_text(arm_toml(with_joints((0,), "white_box"), "One joint."))
    table = installed.package / "data" / "fuzzy_tables" / "table_8.toml"
    demo = ("demo", "--arm", str(arm), "--duration", "5", "--controller", str(table))
    facts = installed.ask(*demo, "--out", str(out))
    assert facts["board"] == "mega2560"
    assert (out / "following.png").stat().st_size > 10_000
    model, controller = tmp_path / "model.toml", tmp_path / "controller.toml"
    logs = (str(out / "before.csv"), "--validate", str(out / "after.csv"))
    installed.ask("identify", *logs, "--arm", str(white_box), "--out", str(model))
    installed.ask("tune", str(model), "--budget", "20", "--out", str(controller))
    assert "joint" in controller.read_text(encoding="utf-8")


def test_the_page_is_served_with_a_bench(installed: Installation, tmp_path: Path) -> None:
    command = [installed.folder / "bin" / "greywhale", "dashboard", "--sim", "--no-browser"]
    environment = {"PATH": str(installed.folder / "bin"), "HOME": str(tmp_path), "PYTHONUNBUFFERED": "1"}
    server = subprocess.Popen(command, cwd=tmp_path, env=environment, stdout=subprocess.PIPE, text=True)
    try:
        assert server.stdout is not None
        address = next(word for line in server.stdout for word in line.split() if word.startswith("http://"))
        with urllib.request.urlopen(address, timeout=60) as answer:
            assert "<title>greywhale" in answer.read().decode()
    finally:
        server.send_signal(signal.SIGINT)
        server.wait(60)
