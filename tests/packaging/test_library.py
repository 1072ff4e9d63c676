"""The library for Arduino's and PlatformIO's registries: arduino-lint's rules by ID, the manifest, the law on a PC.

arduino-lint itself is in no package index that the set-up uses. Left out are LP013 (official libraries), LP017, LP018,
LP042 and LP048 (which ask Arduino's index or the web), LP033 and LP035 (a list of misspelt words).
"""

from __future__ import annotations

import re
import subprocess
from pathlib import Path

import numpy as np
import pytest
from platformio.package.manifest.parser import ManifestParserFactory
from platformio.package.manifest.schema import ManifestSchema

from greywhale.fuzzy.settings import GAIN_UNIT, SET_UNIT, JointSettings
from tests.packaging.test_version import VERSION
from tools.library import NAME, tree, write

URL = "https://example.org/greywhale-fuzzy.git"
GOOD = tree(URL)

# The files that a library may have, and no others.
# LS004, LS006, LS007, LS009 to LS012, LP001 to LP004, LD003, LD005, LD006, SS001.
PLACES = re.compile(
    r"library\.(properties|json)|keywords\.txt|LICENSE|README\.md|extras/[\w.]+"
    r"|src/\w+\.h|src/\w+/\w+\.(h|cpp|inc|S)|examples/(\w+)/(\3\.ino|\w+\.h)"
)
CATEGORIES = {
    *("Display", "Communication", "Signal Input/Output", "Sensors", "Device Control", "Timing", "Data Storage"),
    *("Data Processing", "Other"),
}
# The form of every field of library.properties; all are there, and no others.
# LP006, LP023 to LP032, LP034, LP043 to LP047, LP049 to LP058.
FIELDS = {
    "name": r"(?i)(?!.*(arduino|library))[a-z0-9][a-z0-9_.-]{0,31}",  # LP007 to LP012, LP014 to LP016
    "version": re.escape(VERSION),  # LP019 to LP022
    "author": r".+",
    "maintainer": r"(?i)(?!.*arduino).+",
    "sentence": r".+",
    "paragraph": r".+",
    "category": "|".join(map(re.escape, CATEGORIES)),  # LP037 to LP039
    "url": r"https://\w.*",  # LP040, LP041
    "architectures": r"\*",
    "includes": r"\w+\.h",
    "license": r"Apache-2\.0",
}


def test_every_file_is_where_a_library_has_it() -> None:
    assert [path for path in GOOD if not PLACES.fullmatch(path)] == []
    assert [path for path in GOOD if path.endswith(".ino")] != []  # LD004
    assert "README.md" in GOOD  # LD001
    assert "Apache License" in GOOD["LICENSE"]  # LD002
    assert not any(re.search(r'#include\s*[<"](?!Arduino\.h)(?i:arduino\.h)', text) for text in GOOD.values())  # LC001


def test_every_field_of_its_properties_has_its_form() -> None:
    lines = [line.split("=", 1) for line in GOOD["library.properties"].splitlines()]  # LP005
    fields = dict(lines)
    assert [key for key, _ in lines] == list(FIELDS)
    assert [key for key, form in FIELDS.items() if not re.fullmatch(form, fields[key])] == []
    assert fields["sentence"] not in fields["paragraph"]  # LP036
    assert {f"src/{fields['name']}.h", f"src/{fields['includes']}"} <= set(GOOD)  # LS001, LS008, LP051, LP052


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
