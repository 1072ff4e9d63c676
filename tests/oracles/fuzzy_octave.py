"""GNU Octave's fuzzy-logic-toolkit as a reference: it reads our .fis and evaluates it on a grid."""

from __future__ import annotations

import shutil
import subprocess
import tempfile
from pathlib import Path

import numpy as np

from greywhale.fuzzy import load_joints
from greywhale.fuzzy.export_fis import export_fis

TABLES = Path(__file__).parents[2] / "shared" / "fuzzy_tables"
POINTS = 41
SCRIPT = """
pkg load fuzzy-logic-toolkit;
axis = linspace(-1, 1, {points});
[ce, e] = meshgrid(axis, axis);
fis = readfis('{fis}');
u = evalfis([e(:) ce(:)], fis);
fid = fopen('{out}', 'wb'); fwrite(fid, u, 'double'); fclose(fid);
"""


def paper_sets() -> dict[str, dict[str, float]]:
    """The paper's sets as a board stores them: before tuning, and each joint of Tables 9 and 10."""
    found = {"before_tuning": load_joints(TABLES / "before_tuning.toml")[0]}
    for table in ("table_9", "table_10"):
        found |= {f"{table}_joint_{j}": joint for j, joint in enumerate(load_joints(TABLES / f"{table}.toml"))}
    return {name: {key: float(value) for key, value in joint.set_values().items()} for name, joint in found.items()}


def octave_grid(name: str, sets: dict[str, float]) -> np.ndarray:
    """u over the 41 x 41 grid, e along the rows."""
    octave = shutil.which("octave-cli")
    if octave is None:
        raise RuntimeError("octave-cli is missing; `make oracles` installs it.")
    with tempfile.TemporaryDirectory() as folder:
        fis, out = Path(folder) / "law.fis", Path(folder) / "u.bin"
        export_fis(fis, name, sets)
        script = SCRIPT.format(points=POINTS, fis=fis, out=out)
        subprocess.run([octave, "--quiet", "--no-gui", "--eval", script], check=True, capture_output=True, timeout=600)
        return np.fromfile(out, np.float64).reshape(POINTS, POINTS, order="F")
