"""The library for Arduino's and PlatformIO's registries: arduino-lint's rules by ID, the manifest, the law on a PC.

arduino-lint itself is in no package index that the set-up uses. Left out are LP013 (official libraries), LP017, LP018,
LP042 and LP048 (which ask Arduino's index or the web), LP033 and LP035 (a list of misspelt words).
"""

from __future__ import annotations

import re
import subprocess
from collections.abc import Callable, Mapping
from pathlib import Path
from urllib.parse import urlparse

import numpy as np
import pytest
from platformio.package.manifest.parser import ManifestParserFactory
from platformio.package.manifest.schema import ManifestSchema

from greywhale.fuzzy.settings import GAIN_UNIT, SET_UNIT, JointSettings
from tests.packaging.test_version import VERSION
from tools.library import NAME, tree, write

URL = "https://example.org/greywhale-fuzzy.git"
GOOD = tree(URL)
PROPERTIES = "library.properties"
Files = Mapping[str, str]
Holds = Callable[[Files], bool]
Spoil = Callable[[Files], Files]

CATEGORIES = {
    *("Display", "Communication", "Signal Input/Output", "Sensors", "Device Control", "Timing", "Data Storage"),
    *("Data Processing", "Other"),
}
FIELDS = {
    *("name", "version", "author", "maintainer", "sentence", "paragraph", "category", "url", "architectures"),
    *("depends", "dot_a_linkage", "includes", "precompiled", "ldflags", "license"),
}


def field(files: Files, key: str) -> str:
    return dict(line.split("=", 1) for line in files[PROPERTIES].splitlines()).get(key, "")


def put(key: str, value: str) -> Spoil:
    line = f"{key}={value}\n"
    return lambda files: {
        **files,
        PROPERTIES: re.sub(rf"^{key}=.*\n", "", files[PROPERTIES], flags=re.MULTILINE) + line,
    }


def drop(key: str) -> Spoil:
    return lambda files: {**files, PROPERTIES: re.sub(rf"^{key}=.*\n", "", files[PROPERTIES], flags=re.MULTILINE)}


def add(path: str, text: str = "") -> Spoil:
    return lambda files: {**files, path: text}


def without(part: str) -> Spoil:
    return lambda files: {path: text for path, text in files.items() if part not in path}


def has(key: str) -> Holds:
    return lambda files: field(files, key).strip() != ""


def lacks(key: str) -> Holds:
    return lambda files: f"\n{key}=" not in files[PROPERTIES]


def spelt(name: str) -> Holds:
    """No folder or file at the root is like this name but in its case."""
    return lambda files: all(top == name or top.lower() != name for top in {path.split("/")[0] for path in files})


def headers(files: Files) -> set[str]:
    return {path.removeprefix("src/") for path in files if re.fullmatch(r"src/[^/]+\.h", path)}


def sketches(files: Files) -> list[str]:
    return [path for path in files if path.endswith((".ino", ".pde"))]


RULES: dict[str, tuple[Holds, Spoil]] = {
    "LS001 a library": (lambda files: bool(headers(files)), without("src/Greywhale")),
    "LS004 no submodule": (lambda files: ".gitmodules" not in files, add(".gitmodules")),
    "LS006 no .development": (lambda files: ".development" not in files, add(".development")),
    "LS007 no .exe": (lambda files: not any(path.endswith(".exe") for path in files), add("extras/a.exe")),
    "LS008 a header of its name": (lambda files: f"{field(files, 'name')}.h" in headers(files), put("name", "Other")),
    "LS009 src": (spelt("src"), add("Src/a.h")),
    "LS010 no utility": (lambda files: not any(path.startswith("utility/") for path in files), add("utility/a.h")),
    "LS011 LS012 extras": (
        lambda files: all(
            path.split("/")[0] == "extras" for path in files if re.match(r"extra[^/]*/", path, re.IGNORECASE)
        ),
        add("extra/a"),
    ),
    "LP001 LP002 LP003 library.properties": (spelt(PROPERTIES), add("Library.properties")),
    "LP004 one library.properties": (
        lambda files: sum(path.endswith(PROPERTIES) for path in files) == 1,
        add(f"src/{PROPERTIES}"),
    ),
    "LP005 its format": (
        lambda files: all(re.fullmatch(r"\w+=.*", line) for line in files[PROPERTIES].splitlines()),
        lambda files: {**files, PROPERTIES: files[PROPERTIES] + "nonsense\n"},
    ),
    "LP006 its fields": (
        lambda files: {line.split("=")[0] for line in files[PROPERTIES].splitlines()} <= FIELDS,
        put("architecture", "*"),
    ),
    "LP007 LP008 LP009 LP010 LP011 LP015 name": (
        lambda files: re.fullmatch(r"[A-Za-z0-9][A-Za-z0-9_.-]{0,31}", field(files, "name")) is not None,
        put("name", "Greywhale Fuzzy"),
    ),
    "LP012 LP014 LP016 words in the name": (
        lambda files: re.search("arduino|library", field(files, "name"), re.IGNORECASE) is None,
        put("name", "FuzzyLibrary"),
    ),
    "LP019 LP020 LP021 version": (
        lambda files: re.fullmatch(r"\d+\.\d+\.\d+", field(files, "version")) is not None,
        put("version", "v1"),
    ),
    "LP022 the tag's version": (lambda files: field(files, "version") == VERSION, put("version", "0.0.1")),
    "LP023 LP024 author": (has("author"), drop("author")),
    "LP025 LP026 maintainer": (has("maintainer"), put("maintainer", "")),
    "LP027 LP057 not Arduino": (
        lambda files: "arduino" not in field(files, "maintainer").lower(),
        put("maintainer", "The Arduino team"),
    ),
    "LP028 LP029 LP030 no email": (lacks("email"), put("email", "a@b.c")),
    "LP031 LP032 sentence": (has("sentence"), drop("sentence")),
    "LP034 paragraph": (has("paragraph"), drop("paragraph")),
    "LP036 no repeated sentence": (
        lambda files: field(files, "sentence") not in field(files, "paragraph"),
        lambda files: put("paragraph", field(files, "sentence"))(files),
    ),
    "LP037 LP038 LP039 category": (
        lambda files: field(files, "category") in CATEGORIES,
        put("category", "Uncategorized"),
    ),
    "LP040 LP041 LP056 url": (
        lambda files: urlparse(field(files, "url")).scheme == "https" and bool(urlparse(field(files, "url")).netloc),
        put("url", "greywhale"),
    ),
    "LP043 LP044 LP045 LP046 architectures": (
        lambda files: field(files, "architectures") == "*",
        drop("architectures"),
    ),
    "LP047 LP058 no depends": (lacks("depends"), put("depends", "")),
    "LP049 LP050 no dot_a_linkage": (lacks("dot_a_linkage"), put("dot_a_linkage", "true")),
    "LP051 LP052 includes": (lambda files: field(files, "includes") in headers(files), put("includes", "Servo.h")),
    "LP053 LP054 not precompiled": (lacks("precompiled"), put("precompiled", "full")),
    "LP055 no ldflags": (lacks("ldflags"), put("ldflags", "")),
    "LC001 Arduino.h": (
        lambda files: (
            not any(re.search(r'#include\s*[<"](?!Arduino\.h)(?i:arduino\.h)', text) for path, text in files.items())
        ),
        add("src/a.h", "#include <arduino.h>\n"),
    ),
    "LD001 readme": (lambda files: "README.md" in files, without("README")),
    "LD002 licence": (lambda files: "Apache License" in files.get("LICENSE", ""), without("LICENSE")),
    "LD003 no stray sketch": (
        lambda files: all(path.startswith("examples/") for path in sketches(files)),
        add("a/a.ino"),
    ),
    "LD004 examples": (lambda files: len(sketches(files)) >= 1, without(".ino")),
    "LD005 LD006 examples' folder": (
        lambda files: all(
            path.split("/")[0] == "examples" for path in files if re.match(r"example[^/]*/", path, re.IGNORECASE)
        ),
        add("Example/a/a.txt"),
    ),
    "SS001 a sketch's name": (
        lambda files: all(re.fullmatch(r"examples/(\w+)/\1\.ino", path) for path in sketches(files)),
        add("examples/One/Two.ino"),
    ),
}


@pytest.mark.parametrize("rule", RULES)
def test_a_rule_of_arduino_lint(rule: str) -> None:
    holds, spoil = RULES[rule]
    assert holds(GOOD)
    assert not holds(spoil(GOOD))


@pytest.mark.slow
def test_the_folder_is_what_was_made(tmp_path: Path) -> None:
    """LS002, LS003: the folder's name; LS005: no link in it. Written anew, it is the same; another folder is kept."""
    folder = tmp_path / NAME
    for _ in range(2):
        write(folder, URL)
        found = {path.relative_to(folder).as_posix(): path for path in folder.rglob("*") if path.is_file()}
        assert {name: path.read_text(encoding="utf-8") for name, path in found.items()} == GOOD
        assert not any(path.is_symlink() for path in folder.rglob("*"))
    (tmp_path / "mine").mkdir()
    with pytest.raises(SystemExit, match="is no library"):
        write(tmp_path / "mine", URL)


def test_platformio_reads_the_manifest(tmp_path: Path) -> None:
    """All but the licence, which it looks up in the web."""
    (tmp_path / "library.json").write_text(GOOD["library.json"])
    manifest = ManifestParserFactory.new_from_file(str(tmp_path / "library.json")).as_dict()
    assert manifest.pop("license") == "Apache-2.0"
    assert ManifestSchema().load_manifest(manifest)["version"] == VERSION


PROGRAM = """
#include <GreywhaleFuzzy.h>
#include <stdio.h>
constexpr fuzzy_pdi::Settings settings = greywhale::settings(0.5, 0.16, 0.3, 12.0);
static_assert(greywhale::angle(-0.5) == -2048, "rad");
int main() {
  greywhale::FuzzyPdi motor;
  if (motor.begin(settings, 0) || motor.refusal() != codes::Refusal::period) return 1;
  if (!motor.begin(settings, 20)) return 2;
  if (greywhale::duty(-6000, 12000) != 127 || greywhale::duty(-32768, 12000) != 255) return 3;
  int16_t in[2];
  while (fread(in, 2, 2, stdin) == 2) {
    const int16_t volts = motor.update(in[0], in[1], 9000);
    fwrite(&volts, 2, 1, stdout);
  }
}
"""


@pytest.mark.slow
def test_it_runs_on_a_pc_with_the_firmwares_bits(tmp_path: Path) -> None:
    write(tmp_path / NAME, URL)
    (tmp_path / "main.cpp").write_text(PROGRAM)
    sources = [tmp_path / "main.cpp", *sorted((tmp_path / NAME / "src").rglob("*.cpp"))]
    flags = ["-std=c++11", "-Wall", "-Wextra", "-Wconversion", "-Werror", f"-I{tmp_path / NAME / 'src'}"]
    subprocess.run(["c++", *flags, *map(str, sources), "-o", str(tmp_path / "main")], check=True)
    e, ce = round(0.3 * SET_UNIT), round(0.1 * SET_UNIT)
    kp, kd, ki = (round(factor * GAIN_UNIT) for factor in (0.5, 0.16, 0.3))
    joint = JointSettings(-e, -e, e, e, -ce, -ce, ce, ce, kp, kd, ki, 12000)
    wanted, found = np.random.default_rng(2).integers(-8000, 8001, (2, 2000)).astype("<i2")
    rows = np.column_stack([wanted, found]).tobytes()
    done = subprocess.run([str(tmp_path / "main")], input=rows, capture_output=True, check=True)
    expected = joint.controller(20).run(wanted, found, np.full(2000, 9000, np.uint16))["volts_mv"]
    np.testing.assert_array_equal(np.frombuffer(done.stdout, "<i2"), expected)
