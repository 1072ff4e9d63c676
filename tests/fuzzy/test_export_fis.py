"""The .fis file, and GNU Octave's evaluation of it: golden_octave.npz, made by tests/oracles/write_fuzzy_golden.py."""

from __future__ import annotations

from fractions import Fraction
from pathlib import Path

import numpy as np
import pytest

from greywhale.fuzzy import exact, load_joints
from greywhale.fuzzy.export_fis import export_fis, fis_text

TABLES = Path(__file__).parents[2] / "shared" / "fuzzy_tables"
GOLDEN = np.load(Path(__file__).with_name("golden_octave.npz"))


def _sets(name: str) -> dict[str, Fraction]:
    table, _, joint = name.partition("_joint_")
    return load_joints(TABLES / f"{table}.toml")[int(joint or 0)].set_values()


def test_every_set_of_the_paper_is_there() -> None:
    tuned = {f"table_{table}_joint_{joint}" for table in (9, 10) for joint in range(4)}
    assert set(GOLDEN.files) == {"before_tuning", *tuned}


@pytest.mark.parametrize("name", GOLDEN.files)
def test_octave_agrees_with_the_exact_law(name: str) -> None:
    """At every second of the 41 places of either axis."""
    sets = _sets(name)
    axis = [Fraction(k, 10) for k in range(-10, 11)]
    ours = np.array([[float(exact.infer(x, y, sets).u) for y in axis] for x in axis])
    np.testing.assert_allclose(GOLDEN[name][::2, ::2], ours, rtol=0, atol=1e-12)


def test_the_file_says_what_matlab_expects(tmp_path: Path) -> None:
    sets = {key: float(value) for key, value in _sets("before_tuning").items()}
    export_fis(tmp_path / "joint0.fis", "joint0", sets)
    text = (tmp_path / "joint0.fis").read_text()
    assert text == fis_text("joint0", sets)
    lines = text.splitlines()
    assert lines[0] == "[System]"
    assert "Name='joint0'" in lines
    assert "Range=[-1 1]" in lines
    assert "MF1='NE':'trapmf',[-1.01 -1 -0.29998779296875 0]" in lines
    assert "ImpMethod='prod'" in lines
    assert "Range=[-1.25 1.25]" in lines
    assert "MF1='NU':'trimf',[-1.25 -1 -0.75]" in lines
    assert lines[lines.index("[Rules]") + 1 :] == [
        "1 1, 1 (1) : 1",
        "1 2, 1 (1) : 1",
        "1 3, 2 (1) : 1",
        "2 1, 1 (1) : 1",
        "2 2, 2 (1) : 1",
        "2 3, 3 (1) : 1",
        "3 1, 2 (1) : 1",
        "3 2, 3 (1) : 1",
        "3 3, 3 (1) : 1",
    ]
