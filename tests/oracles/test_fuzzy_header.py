"""The reference of a generated header agrees with GNU Octave and with scikit-fuzzy; a Cortex-M0 gives its bits."""

from __future__ import annotations

import shutil
import subprocess
import sys
from pathlib import Path

import numpy as np
import pytest
import skfuzzy
from numpy.typing import NDArray

from greywhale.files import fis
from greywhale.fuzzy import table_twin
from greywhale.fuzzy.export_header import make_header
from greywhale.fuzzy.header_proof import exact_u
from greywhale.fuzzy.table_law import TableLaw, from_fis
from greywhale.fuzzy.table_twin import END
from tools.support.fis_files import table, uneven

sys.path.insert(0, str(Path(__file__).parent))
from test_fuzzy_cortex_m0 import FLAGS, LINKING, QEMU

FILES = {"table5": table(5), "uneven": uneven()}
SAMPLES = {"octave": 251, "scikit-fuzzy": 4001}  # of the output
POINTS = 7
SCRIPT = """
pkg load fuzzy-logic-toolkit;
in = fopen('in.bin'); x = fread(in, [2, Inf], 'double')'; fclose(in);
u = evalfis(x, readfis('law.fis'), {samples});
out = fopen('out.bin', 'wb'); fwrite(out, u, 'double'); fclose(out);
"""


def places() -> NDArray[np.int64]:
    """POINTS x POINTS of them, none of which lies on a corner."""
    axis = np.linspace(-END, END, POINTS).round().astype(int)
    return np.array(np.meshgrid(axis, axis, indexing="ij")).reshape(2, -1)


def real(law: TableLaw) -> NDArray[np.float64]:
    """The places in the file's own units."""
    rows = [
        float(axis.low) + (x + END) / (2 * END) * float(axis.high - axis.low)
        for axis, x in zip(law.inputs, places(), strict=True)
    ]
    return np.array(rows)


def as_output(law: TableLaw, u: NDArray[np.float64]) -> NDArray[np.float64]:
    return float(law.output.low) + (u + END) / (2 * END) * float(law.output.high - law.output.low)


def test_octave(tmp_path: Path) -> None:
    """It adds samples up, with those at the ends counted whole: so far apart the two may be."""
    law = from_fis(fis.parse(FILES["table5"]), "table5")
    octave = shutil.which("octave-cli")
    assert octave is not None, "octave-cli is missing; `make oracles` installs it."
    (tmp_path / "law.fis").write_text(FILES["table5"])
    real(law).T.astype(float).tofile(tmp_path / "in.bin")
    script = SCRIPT.format(samples=SAMPLES["octave"])
    subprocess.run(
        [octave, "--quiet", "--no-gui", "--eval", script], check=True, capture_output=True, cwd=tmp_path, timeout=100
    )
    found = np.fromfile(tmp_path / "out.bin")
    assert np.ptp(found) > 300
    np.testing.assert_allclose(as_output(law, exact_u(law, *places())), found, rtol=0, atol=1e-2)


@pytest.mark.parametrize("name", FILES)
def test_scikit_fuzzy(name: str) -> None:
    """Its own membership functions, and its centroid of a finely sampled area."""
    law = from_fis(fis.parse(FILES[name]), name)
    universe = np.linspace(float(law.output.low), float(law.output.high), SAMPLES["scikit-fuzzy"])
    outputs = [skfuzzy.trapmf(universe, list(map(float, one))) for one in law.output.sets]
    members = [
        [skfuzzy.trapmf(x, list(map(float, one))) for one in axis.sets]
        for axis, x in zip(law.inputs, real(law), strict=True)
    ]
    found = []
    for point in range(POINTS * POINTS):
        area = np.zeros_like(universe)
        for i, row in enumerate(law.table):
            for j, then in enumerate(row):
                height = min(members[0][i][point], members[1][j][point])
                area = np.fmax(area, np.fmin(height, outputs[then]))
        found.append(skfuzzy.defuzz(universe, area, "centroid"))
    np.testing.assert_allclose(as_output(law, exact_u(law, *places())), found, rtol=0, atol=2e-4)


PROGRAM = """
#include <stdint.h>
#include <stdio.h>
#include <unistd.h>
#include "law.h"
extern "C" {
extern uint32_t data_start, data_end, data_image, bss_start, bss_end, stack_top;
void initialise_monitor_handles();
[[noreturn]] void start();
}
void start() {
  const uint32_t* image = &data_image;
  for (uint32_t* word = &data_start; word != &data_end; ++word) *word = *image++;
  for (uint32_t* word = &bss_start; word != &bss_end; ++word) *word = 0;
  initialise_monitor_handles();
  FILE* const out = fopen("result.bin", "wb");
  fputc(law::self_test(), out);
  fclose(out);
  _exit(0);
}
struct Vectors {
  uint32_t* stack;
  void (*reset)();
};
__attribute__((section(".vectors"), used)) const Vectors vectors = {&stack_top, start};
"""


@pytest.mark.parametrize("wrong", [False, True], ids=["right", "one answer wrong"])
def test_self_test_on_a_cortex_m0(tmp_path: Path, wrong: bool) -> None:
    law = from_fis(fis.parse(FILES["uneven"]), "uneven")
    text = make_header(law, "uneven.fis", "law.h").text
    answer = table_twin.u(table_twin.of_law(law), np.array([-END]), np.array([-END]))[0]
    row = f"{{{-END}, {-END}, {answer}}},"
    assert row in text
    (tmp_path / "law.h").write_text(text.replace(row, f"{{{-END}, {-END}, {answer + 1}}},") if wrong else text)
    (tmp_path / "main.cpp").write_text(PROGRAM)
    command = ["arm-none-eabi-g++", *FLAGS, *LINKING, "main.cpp", "-o", "law.elf"]
    subprocess.run(command, check=True, cwd=tmp_path)
    subprocess.run([*QEMU, "law.elf"], check=True, cwd=tmp_path, timeout=60)
    assert (tmp_path / "result.bin").read_bytes() == (b"\1" if wrong else b"\0")
