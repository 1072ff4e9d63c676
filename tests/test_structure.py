"""The package's build: imports point one way, what must have one owner has it, docstrings say what things are."""

from __future__ import annotations

import ast
import re
from collections.abc import Iterator, Mapping
from graphlib import CycleError, TopologicalSorter
from pathlib import Path

import pytest

from tools import ROOT

SOURCE = ROOT / "host" / "src"
# Beside greywhale: the bench, which comes in the same distribution, and the paper, which has one of its own.
BENCH = ROOT / "sim" / "bench"
PAPER = ROOT / "studies" / "paper"
# The rooms of the package in the order in which they stand on each other: each imports only rooms before it.
ROOMS = [
    *("base", "protocol", "arm", "files", "fuzzy", "measure", "loop", "board", "pictures"),
    *("optimise", "identify", "observe", "tune", "commission", "adapt", "dashboard", "cli"),
]
# Of these the paper needs no more.
UNKNOWN_TO_THE_PAPER = {"board", "commission", "adapt", "dashboard"}
PAGE = ROOT / "host" / "web" / "src"
# The page's rooms in the same order. Views know the interfaces in session, and no source behind them.
PAGE_ROOMS = ["link", "parts", "session", "files", "tuner", "sources", "views", "entries"]
UNKNOWN_TO_VIEWS = {"sources", "tuner"}
# A rule that two languages hold is written twice: these files of the page repeat one of Python's, and no others may.
TWINS = {"session/law.ts", "tuner/search.ts", "tuner/space.ts", "tuner/wolf_whale.ts"}
# A docstring says what a thing is or does; one that begins with such a word describes it from outside, as a question.
QUESTIONS = re.compile(r"(What|Whether|How|Where|Which|Who|Whose|When|Why|The same)\b")
# The extension module, whose name begins with an underscore. It is a room of its own with public classes and functions.
EXTENSIONS = {"_native"}


def modules(source: Path) -> dict[str, Path]:
    """Every module below a folder by its dotted name."""
    found = {}
    for path in sorted(source.rglob("*.py")):
        parts = path.relative_to(source).with_suffix("").parts
        found[".".join(parts[:-1] if parts[-1] == "__init__" else parts)] = path
    return found


def imports(name: str, path: Path, known: Mapping[str, Path]) -> Iterator[str]:
    """The modules of ours that a module imports, anywhere in it: in functions and for type checkers too."""
    package = name if path.name == "__init__.py" else name.rpartition(".")[0]
    for node in ast.walk(ast.parse(path.read_text(encoding="utf-8"))):
        if isinstance(node, ast.Import):
            targets = [alias.name for alias in node.names]
        elif isinstance(node, ast.ImportFrom):
            above = package.split(".")[: len(package.split(".")) - node.level + 1] if node.level else []
            base = ".".join([*above, *([node.module] if node.module else [])])
            targets = [f"{base}.{alias.name}" if f"{base}.{alias.name}" in known else base for alias in node.names]
        else:
            continue
        yield from (target for target in targets if target in known and "." in target and target != name)


def graph(source: Path) -> dict[str, set[str]]:
    known = modules(source)
    return {name: set(imports(name, path, known)) for name, path in known.items()}


def folder_of(name: str, source: Path) -> str:
    """The package that a module lies in."""
    return name if (source / Path(*name.split(".")) / "__init__.py").exists() else name.rpartition(".")[0]


def circle(edges: Mapping[str, set[str]]) -> list[str]:
    try:
        TopologicalSorter(edges).prepare()
    except CycleError as error:
        return list(error.args[1])
    return []


SOURCES = pytest.mark.parametrize("source", [SOURCE, BENCH, PAPER], ids=["host", "bench", "paper"])


@SOURCES
def test_no_module_imports_in_a_circle(source: Path) -> None:
    assert circle(graph(source)) == []


@SOURCES
def test_no_folder_imports_in_a_circle(source: Path) -> None:
    """A module at the top of a package counts as a room of its own, as do the modules in each folder together."""
    (top,) = (path.parent.name for path in source.glob("*/__init__.py"))
    rooms: dict[str, set[str]] = {}
    for name, targets in graph(source).items():
        here = folder_of(name, source)
        here = name if here == top else here
        for target in targets:
            there = folder_of(target, source)
            there = target if there == top else there
            if there != here:
                rooms.setdefault(here, set()).add(there)
    assert circle(rooms) == []


def test_a_room_imports_only_rooms_below_it() -> None:
    """Beside these rooms there are only the package itself, its entry and the extension."""
    for name, targets in graph(SOURCE).items():
        room, *_ = (*name.split(".")[1:], "")
        if room not in {"", "__main__"}:
            below = {"_native", *ROOMS[: ROOMS.index(room) + 1]}
            beyond = {target for target in targets if target.split(".")[1] not in below}
            assert not beyond, f"{name} imports {', '.join(sorted(beyond))}"


@pytest.mark.parametrize("source", [SOURCE, BENCH], ids=["host", "bench"])
def test_greywhale_finds_the_paper_by_entry_point_and_names_none_of_its_modules(source: Path) -> None:
    assert [path for path in source.rglob("*.py") if "greywhale_paper" in path.read_text(encoding="utf-8")] == []


def test_the_paper_imports_only_public_rooms() -> None:
    """No room that serves a connected arm alone, no private name, and not the extension."""
    known, public = modules(SOURCE), set(ROOMS) - UNKNOWN_TO_THE_PAPER
    for name, path in modules(PAPER).items():
        beyond = {target for target in imports(name, path, known) if target.split(".")[1] not in public}
        assert not beyond, f"{name} imports {', '.join(sorted(beyond))}"
        text = path.read_text(encoding="utf-8")
        assert [f"{name}:{line}: {used}" for line, used in private_uses(ast.parse(text))] == []
        assert "_native" not in text, name


def test_a_commissioning_and_an_adaptation_stand_beside_each_other() -> None:
    """What both need lies in rooms below: neither imports the other."""
    jobs = ("commission", "adapt")
    crossing = {
        (name, target)
        for name, targets in graph(SOURCE).items()
        for target in targets
        if {name.split(".")[1], target.split(".")[1]} == set(jobs)
    }
    assert crossing == set()


def page_graph() -> dict[str, set[str]]:
    """Every module of the page with those that it imports, by their paths, for the type checker too."""
    found = {}
    for path in PAGE.rglob("*.ts"):
        named = re.findall(r'(?:from |import\(|import )"(\.[^"]*)"', path.read_text(encoding="utf-8"))
        modules = [(path.parent / name).resolve().relative_to(PAGE) for name in named]
        found[str(path.relative_to(PAGE))] = {f"{module}.ts" for module in modules if not module.suffix}
    return found


def test_the_page_imports_only_rooms_below_and_never_in_a_circle() -> None:
    edges = page_graph()
    assert {name.split("/")[0] for name in edges} == set(PAGE_ROOMS)
    assert circle(edges) == []
    for name, targets in edges.items():
        assert targets <= set(edges), name
        room = name.split("/")[0]
        below = set(PAGE_ROOMS[: PAGE_ROOMS.index(room) + 1]) - (UNKNOWN_TO_VIEWS if room == "views" else set())
        beyond = {target for target in targets if target.split("/")[0] not in below}
        assert not beyond, f"{name} imports {', '.join(sorted(beyond))}"


def test_the_page_repeats_no_further_file_of_python() -> None:
    """A file that repeats one names it; whoever adds one, adds a rule to keep twice."""
    names = re.compile(r"(?<![a-z_/])(?!tools/)[a-z_]+/[a-z_/]+\.py\b")
    assert {
        str(path.relative_to(PAGE)) for path in PAGE.rglob("*.ts") if names.search(path.read_text("utf-8"))
    } == TWINS


@pytest.mark.parametrize(
    ("folder", "forbidden"), [("tools", "tests"), ("studies", "tests"), ("tests", "tools.benchmarks")]
)
def test_what_is_not_installed_points_one_way(folder: str, forbidden: str) -> None:
    """Tests stand on tools, and nothing stands on tests or on benchmarks."""
    sources = {path: path.read_text(encoding="utf-8") for path in (ROOT / folder).rglob("*.py")}
    assert [
        str(path) for path, text in sources.items() if re.search(rf"^ *(from|import) {forbidden}\b", text, re.M)
    ] == []


@pytest.mark.parametrize(
    ("word", "owner"),
    [
        ("_native.ClosedLoop", "greywhale/loop/closed_loop.py"),
        ("_native.leader_readings", "greywhale/loop/closed_loop.py"),
        ("_native.simulate_ideal", "greywhale/tune/judge/floor.py"),
        ("_native.simulate_windows", "greywhale/identify/windows.py"),
        ("_native.plant_row", "greywhale/arm/plants.py"),
        ("_native.calibration_rule(", "greywhale/board/calibrate/rules.py greywhale/board/pots.py"),
        ("_native.relative_costs", "greywhale/tune/search/objective.py"),
        ("_native.unrest_prices", "greywhale/tune/judge/margins.py"),
        ("_native.falls_short", "greywhale/tune/judge/standard.py"),
        ("PARAMETERS[", "greywhale/board/upload.py greywhale/board/refusal.py"),
        ("os.replace(", "greywhale/base/formats/draft.py"),
        ("os.fsync(", "greywhale/base/formats/draft.py"),
        ("serial.Serial(", "greywhale/protocol/transport.py"),
        ("subprocess.Popen(", "greywhale/base/processes.py"),
        ("get_context(", "greywhale/base/study/workers.py"),
        ("matplotlib.", "greywhale/pictures/plotting.py greywhale/pictures/page.py greywhale_paper/render/pdf.py"),
        ("reportlab", "greywhale_paper/render/pdf.py"),
    ],
)
def test_each_thing_has_its_owner(word: str, owner: str) -> None:
    """The native code, the table by index, the port and the disk are touched where they belong and nowhere else."""
    users = {
        str(path.relative_to(source))
        for source in (SOURCE, PAPER)
        for path in source.rglob("*.py")
        if word in path.read_text("utf-8")
    }
    assert users == set(owner.split())


def is_private(name: str) -> bool:
    """True if a dotted name goes through a private one; dunders, the extension modules and os._exit are none."""
    parts = set(name.split(".")) - EXTENSIONS - {"_exit"}
    return any(part.startswith("_") and not part.startswith("__") for part in parts)


def private_uses(tree: ast.AST) -> Iterator[tuple[int, str]]:
    """Lines where a module uses what another keeps to itself: as an attribute, imported, or named in a string."""
    for node in ast.walk(tree):
        if isinstance(node, ast.Attribute):
            own = isinstance(node.value, ast.Name) and node.value.id in {"self", "cls"}
            names = [] if own else [node.attr]
        elif isinstance(node, ast.Import):
            names = [alias.name for alias in node.names]
        elif isinstance(node, ast.ImportFrom):
            names = [node.module or "", *(alias.name for alias in node.names)]
        elif isinstance(node, ast.Call):  # getattr(x, "_y"), monkeypatch.setattr("x._y", ...) and their like
            called = node.func.attr if isinstance(node.func, ast.Attribute) else getattr(node.func, "id", "")
            words = [one.value for one in node.args[:2] if isinstance(one, ast.Constant) and isinstance(one.value, str)]
            names = words if called in {"getattr", "setattr", "delattr", "hasattr"} else []
        else:
            continue
        yield from ((node.lineno, name) for name in names if is_private(name))


def test_tests_use_what_is_public() -> None:
    uses = {
        f"{path.relative_to(ROOT)}:{line}: {name}"
        for path in (ROOT / "tests").rglob("*.py")
        for line, name in private_uses(ast.parse(path.read_text(encoding="utf-8")))
    }
    assert uses == set()


def docstrings(path: Path) -> Iterator[tuple[str, str]]:
    """The name and the docstring of a module, and of each class and function in it; "" for none."""
    for node in ast.walk(ast.parse(path.read_text(encoding="utf-8"))):
        if isinstance(node, ast.Module | ast.ClassDef | ast.FunctionDef | ast.AsyncFunctionDef):
            yield getattr(node, "name", "the module"), ast.get_docstring(node) or ""


def test_docstrings_say_what_a_thing_is_or_does() -> None:
    packages = (SOURCE / "greywhale", ROOT / "sim/bench/greywhale_sim", ROOT / "tools")
    assert [
        f"{path.relative_to(ROOT)}: {name}: {text.splitlines()[0]}"
        for package in packages
        for path in package.rglob("*.py")
        for name, text in docstrings(path)
        if QUESTIONS.match(text)
    ] == []
