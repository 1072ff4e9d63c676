"""A generated header gives the twin's bits on a PC and on a board, as near to the exact centroid as it says."""

from __future__ import annotations

import subprocess
from fractions import Fraction
from functools import cache
from itertools import combinations, pairwise
from pathlib import Path

import numpy as np
import pytest

from greywhale.base.errors import UserError
from greywhale.files import fis
from greywhale.fuzzy import exact, load_joints, table_twin
from greywhale.fuzzy.exact import trapezoid
from greywhale.fuzzy.export_fis import fis_text
from greywhale.fuzzy.export_header import Header, make_header, name_of
from greywhale.fuzzy.header_proof import exact_u, prove
from greywhale.fuzzy.table_law import TableLaw, from_fis
from greywhale.fuzzy.table_twin import END, Ints
from tools.support.fis_files import table, uneven
from tools.support.header_on_board import HeaderOnBoard

JOINT = load_joints(Path(__file__).parents[2] / "shared/fuzzy_tables/table_10.toml")[0]
SETS = JOINT.set_values()
FILES = {
    "controller": fis_text("joint", {key: float(value) for key, value in SETS.items()}),
    "table3": table(3),
    "table5": table(5),
    "table7": table(7),
    "uneven": uneven(),
}
LAWS = pytest.mark.parametrize("name", FILES)


@cache
def law_of(name: str) -> TableLaw:
    return from_fis(fis.parse(FILES[name]), name)


@cache
def header_of(name: str) -> Header:
    return make_header(law_of(name), name, f"{name}.h", JOINT if name == "controller" else None)


def places(count: int, seed: int = 0) -> tuple[Ints, Ints]:
    random = np.random.default_rng(seed)
    e, ce = random.integers(-END, END + 1, (2, count))
    near = random.integers(0, 2, count) == 0  # where a controller works
    return np.where(near, e // 16, e), np.where(near, ce // 16, ce)


def area_and_moment(law: TableLaw, heights: list[Fraction]) -> tuple[Fraction, Fraction]:
    """By the definition, in fractions: the highest of the clipped or scaled sets, from bend to bend."""

    def value(k: int, z: Fraction) -> Fraction:
        member = trapezoid(z, *corners[k])
        return min(member, heights[k]) if law.clipped else member * heights[k]

    corners = law.output.scaled()
    bends = {Fraction(-1), Fraction(1)}
    lines = [(Fraction(0), heights[k]) for k in range(len(corners))]
    for k, (a, b, c, d) in enumerate(corners):
        full = Fraction(1) if law.clipped else heights[k]
        bends |= {a, b, c, d}
        lines += [(full / (b - a), -a * full / (b - a))] if b > a else []
        lines += [(-full / (d - c), d * full / (d - c))] if d > c else []
    bends |= {(q - p) / (m - n) for (m, p), (n, q) in combinations(lines, 2) if m != n}
    area = moment = Fraction(0)
    ordered = sorted(z for z in bends if -1 <= z <= 1)
    for left, right in pairwise(ordered):
        third = (right - left) / 3  # inside, where no set has a step
        low, high = (max(value(k, z) for k in range(len(corners))) for z in (left + third, right - third))
        slope = (high - low) / third
        middle, width = (left + right) / 2, right - left
        area += width * (low + high) / 2
        moment += middle * width * (low + high) / 2 + slope * width**3 / 12
    return area, moment


@LAWS
def test_the_reference_is_the_centroid_by_its_definition(name: str) -> None:
    law = law_of(name)
    e, ce = places(12)
    for one, other, found in zip(e.tolist(), ce.tolist(), exact_u(law, e, ce).tolist(), strict=True):
        members = [
            [trapezoid(Fraction(x, END), *corners) for corners in axis.scaled()]
            for axis, x in zip(law.inputs, (one, other), strict=True)
        ]
        heights = [Fraction(0)] * len(law.output.sets)
        for i, row in enumerate(law.table):
            for j, then in enumerate(row):
                heights[then] = max(heights[then], min(members[0][i], members[1][j]))
        area, moment = area_and_moment(law, heights)
        assert found == pytest.approx(float(moment / area * END), abs=1e-6)


def test_a_controller_is_the_firmwares_exact_law() -> None:
    e, ce = places(200)
    ours = exact_u(law_of("controller"), e, ce) / END * 1.25
    law = [
        exact.infer(Fraction(x, END), Fraction(y, END), SETS).u for x, y in zip(e.tolist(), ce.tolist(), strict=True)
    ]
    np.testing.assert_allclose(ours, [float(u) for u in law], rtol=0, atol=1e-12)


@pytest.mark.slow
@LAWS
def test_no_input_is_beyond_the_bound(name: str) -> None:
    """Nor much beyond the largest difference found, which is for the same file and no other."""
    law, proof = law_of(name), header_of(name).proof
    e, ce = places(50_000, seed=7)
    numbers = table_twin.of_law(law)
    difference = np.abs(table_twin.u(numbers, e, ce) - exact_u(law, e, ce))
    assert difference.max() <= proof.largest + 0.05
    assert 0.5 <= proof.largest <= proof.bound < 2.5
    at = np.array(proof.at)[:, None]
    assert np.abs(table_twin.u(numbers, at[0], at[1]) - exact_u(law, at[0], at[1]))[0] == proof.largest


@pytest.fixture(scope="module")
def compiled(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """One program for this machine with all headers in it, which also shows that they live together."""
    folder = tmp_path_factory.mktemp("headers")
    lines = ["#include <stdio.h>"]
    for name in FILES:
        (folder / f"{name}.h").write_text(header_of(name).text)
        lines.append(f'#include "{name}.h"')
    lines += ["int main(int, char** v) {", "  int16_t in[2];"]
    for name in FILES:
        lines += [
            f"  if (v[1][0] == '{name[0]}' && v[1][5] == '{name[5]}') {{",
            f"    if ({name}::self_test()) return 1;",
        ]
        lines += ["    while (fread(in, 2, 2, stdin) == 2) {", f"      const int16_t u = {name}::u(in[0], in[1]);"]
        lines += ["      fwrite(&u, 2, 1, stdout);", "    }", "  }"]
    lines += ["  static controller::PdI pdi = controller::controller();", "  if (v[1][0] == 'P') {"]
    lines += ["    while (fread(in, 2, 2, stdin) == 2) {", "      const int16_t mv = pdi.step(in[0], in[1]);"]
    lines += ["      fwrite(&mv, 2, 1, stdout);", "    }", "  }", "}"]
    (folder / "all.cpp").write_text("\n".join(lines) + "\n")
    warnings = ["-Wall", "-Wextra", "-Wconversion", "-Werror", "-Wno-unused-function"]
    sanitized = ["-fsanitize=undefined", "-fno-sanitize-recover"]
    command = ["c++", "-std=c++11", "-O1", *warnings, *sanitized, str(folder / "all.cpp"), "-o", str(folder / "all")]
    subprocess.run(command, check=True)
    return folder / "all"


def run(program: Path, name: str, first: Ints, second: Ints) -> Ints:
    rows = np.column_stack([first, second]).astype("<i2").tobytes()
    done = subprocess.run([str(program), name], input=rows, capture_output=True, check=True)
    return np.frombuffer(done.stdout, "<i2").astype(np.int64)


@pytest.mark.slow
@LAWS
def test_same_bits_on_this_machine(compiled: Path, name: str) -> None:
    e, ce = (
        np.concatenate([one, edge])
        for one, edge in zip(places(20_000), np.array([[-END, END], [END, -END]]), strict=True)
    )
    expected = table_twin.u(table_twin.of_law(law_of(name)), e, ce)
    np.testing.assert_array_equal(run(compiled, name, e, ce), expected)


@pytest.mark.slow
def test_the_pdi_follows_the_firmware(compiled: Path) -> None:
    """Its volts are those of the firmware but for the rounding of its inputs, with a limit that bites."""
    random = np.random.default_rng(3)
    error = np.clip(np.cumsum(random.integers(-60, 61, 3000)), -4000, 4000)
    limit = np.where(np.arange(3000) // 300 % 2, 2500, 12000)
    firmware = JOINT.controller(20).run(error.astype(np.int16), np.zeros(3000, np.int16), limit.astype(np.uint16))
    assert firmware["saturated"].any()
    ours = run(compiled, "P", error, limit)
    slope = JOINT.ku_mv / min(abs(float(value)) for value in SETS.values()) / END  # mV a step of an input
    assert np.abs(ours - firmware["volts_mv"]).max() < 2 * slope + 8
    assert np.abs(ours).max() == 12000


@pytest.mark.slow
@pytest.mark.parametrize("name", ["controller", "table5", "uneven"])
def test_same_bits_on_a_board(tmp_path: Path, name: str) -> None:
    path = tmp_path / f"{name}.h"
    path.write_text(header_of(name).text)
    board = HeaderOnBoard(path)
    assert board.self_test() == 0
    e, ce = places(300)
    expected = table_twin.u(table_twin.of_law(law_of(name)), e, ce)
    answers, cycles = zip(*(board.u(*pair) for pair in zip(e.tolist(), ce.tolist(), strict=True)), strict=True)
    assert list(answers) == expected.tolist()
    assert max(cycles) < 10_000  # docs/library.md has those of one compiler


def test_the_self_test_finds_a_wrong_number(tmp_path: Path) -> None:
    text = header_of("table3").text
    at = text.index("shapes[sets_u]")
    wrong = text[:at] + text[at:].replace("{268439552,", "{268539552,", 1)
    assert wrong != text
    (tmp_path / "wrong.h").write_text(wrong)
    command = [
        "c++",
        "-x",
        "c++",
        "-D",
        "GREYWHALE_TABLE3_H_MAIN",
        str(tmp_path / "wrong.h"),
        "-o",
        str(tmp_path / "t"),
    ]
    subprocess.run(command, check=True)
    assert subprocess.run([str(tmp_path / "t")], check=False).returncode > 0


MIDDLE = "{{-16384, 0, 262140u, 32768u}, {16384, 0, 262140u, 32768u}}"  # the set of table3 between the two others
CUT = "{{-16384, 0, 262140u, 32768u}, {0, 0, 0u, 0u}}"  # it ends at 0


@pytest.mark.slow
@pytest.mark.parametrize(
    ("edits", "said"),
    [
        ({}, ""),
        ({MIDDLE: CUT}, ""),  # the set behind it has a height from 1 on
        ({MIDDLE: CUT, "{{0, 16384, 262140u, 32768u}": "{{1, 16384, 262140u, 32768u}"}, "the rules have a hole"),
        ({"{0, 1, 2},\n": "{0, 1, no_rule},\n"}, "the rules have a hole"),
        ({"{1, 2, 2},\n": "{1, 2, 3},\n"}, "rules: every cell is the number of a set of the output, or no_rule"),
        ({MIDDLE: MIDDLE.replace("{16384", "{-9")}, "e_sets: the edges of every set rise"),
    ],
)
def test_a_header_that_was_broken_by_hand_does_not_compile(tmp_path: Path, edits: dict[str, str], said: str) -> None:
    text = header_of("table3").text
    for old, new in edits.items():
        assert old in text
        text = text.replace(old, new, 1)
    (tmp_path / "edited.h").write_text(text)
    command = ["c++", "-std=c++11", "-fsyntax-only", "-x", "c++", str(tmp_path / "edited.h")]
    done = subprocess.run(command, capture_output=True, text=True, check=False)
    assert (done.returncode != 0) == bool(said)
    assert said in done.stderr


def test_a_hole_is_found_where_it_is() -> None:
    text = table(3).replace("'trimf',[-3 0 3]", "'trimf',[-0.5 0 0.5]").replace("[-6 -3 0]", "[-6 -3 -1]")
    law = from_fis(fis.parse(text), "hole.fis")
    with pytest.raises(UserError, match=r"hole.fis: the rules have a hole: at error = -1\.\d+ and change") as caught:
        prove(law, table_twin.of_law(law))
    assert "\n" not in caught.value.message


def test_names() -> None:
    names = ("Law-5.h", "5x5.h", "é.h", "a/b c.h", "default.h")
    assert [name_of(name) for name in names] == ["law_5", "law_5x5", "law", "b_c", "law_default"]


def test_a_files_own_words_stay_in_their_comments(tmp_path: Path) -> None:
    """A name may end in a backslash, in a trigraph of one, or hold a line of its own."""
    text = FILES["table3"].replace("'S0'", "'S0 \\'").replace("'S1'", "'??/'").replace("table3", "*/\x0cé??/")
    header = make_header(from_fis(fis.parse(text), "odd"), "odd??/", "odd.h").text
    (tmp_path / "odd.h").write_text(header)
    command = ["c++", "-std=c++11", "-fsyntax-only", "-Wall", "-Werror", "-x", "c++", str(tmp_path / "odd.h")]
    assert header.isascii()
    subprocess.run([*command, "-D", "GREYWHALE_ODD_H_MAIN"], check=True)
