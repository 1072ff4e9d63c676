"""Controller files: the shipped ones load, wrong ones are refused before a board sees them."""

from __future__ import annotations

import re
from pathlib import Path

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from greywhale.base.errors import UserError
from greywhale.base.formats import toml_file
from greywhale.files import controller
from greywhale.loop import CONTROLLER_COLUMNS, controller_row, default_controller
from greywhale.protocol import schema
from greywhale.protocol.table import ParameterTable
from tools import ROOT

SETS = {
    "Ne_c": -0.3, "Ze_a": -0.3, "Ze_c": 0.3, "Pe_b": 0.3, "Nce_c": -0.1, "Zce_a": -0.1, "Zce_c": 0.1, "Pce_b": 0.1,
}  # fmt: skip
GAINS = {"kp": 0.5, "kd": 0.1, "ki": 0.2, "ku": 15.0}


def text(joint: int = 0, **changes: float) -> str:
    """Four joints, of which one differs."""
    lines = []
    for number in range(4):
        values = {**GAINS, **SETS, **(changes if number == joint else {})}
        lines += ["[[joint]]", *(f"{key} = {values[key]}" for key in GAINS)]
        lines += ["[joint.sets]", *(f"{key} = {values[key]}" for key in SETS)]
    return "\n".join(lines) + "\n"


def load(tmp_path: Path, content: str) -> controller.Controller:
    path = tmp_path / "controller.toml"
    path.write_text(content)
    return controller.load(path)


def test_before_tuning_is_what_the_firmware_starts_with() -> None:
    values = controller.load(ROOT / "shared" / "fuzzy_tables" / "before_tuning.toml").raw_values()
    assert {name: ParameterTable.defaults()[name] for name in values} == values


@pytest.mark.parametrize(
    ("changes", "words"),
    [
        ({"Ne_c": 0.2}, "joint[2].sets.Ne_c is 0.2, but it must be at least -1 and at most -0.01"),
        ({"Ze_a": -0.009}, "joint[2].sets.Ze_a is -0.009, but it must be at least -1 and at most -0.01"),
        ({"Pe_b": 1.01}, "joint[2].sets.Pe_b is 1.01, but it must be at least 0.01 and at most 1"),
        ({"Zce_c": 0.0}, "joint[2].sets.Zce_c is 0.0, but it must be at least 0.01 and at most 1"),
        ({"kp": 65.0}, "joint[2].kp is 65.0, but it must be at least 0 and at most 64."),
        ({"ki": -0.1}, "joint[2].ki is -0.1, but it must be at least 0 and at most 1000."),
        ({"ku": 31.0}, "joint[2].ku is 31.0, but it must be at least 0 and at most 30."),
        ({"kp": 1e-9}, "joint[2].kp is 1e-09, which the board would store as 0; give 0, or at least 1.52588e-05."),
        ({"ku": 0.0001}, "joint[2].ku is 0.0001, which the board would store as 0; give 0, or at least 0.001."),
    ],
)
def test_values_out_of_range_name_key_value_and_range(tmp_path: Path, changes: dict[str, float], words: str) -> None:
    with pytest.raises(UserError, match=re.escape(f"{tmp_path}/controller.toml: {words}")):
        load(tmp_path, text(2, **changes))


@pytest.mark.parametrize("joints", [0, 1, 3, 5])
def test_other_than_four_joints_are_refused(tmp_path: Path, joints: int) -> None:
    one = text().partition("[[joint]]\n")[2].partition("[[joint]]\n")[0]
    words = rf"{joints} \[\[joint\]\] where there must be exactly 4" if joints else "it is empty; choose another file"
    with pytest.raises(UserError, match=rf"controller\.toml: {words}\.$"):
        load(tmp_path, ("[[joint]]\n" + one) * joints)


@given(
    st.fixed_dictionaries(
        {
            **{key: st.floats(-1.0, -0.01) for key in ("Ne_c", "Ze_a", "Nce_c", "Zce_a")},
            **{key: st.floats(0.01, 1.0) for key in ("Ze_c", "Pe_b", "Zce_c", "Pce_b")},
            "kp": st.floats(0, 64),
            "kd": st.floats(0, 64),
            "ki": st.floats(0, 1000),
            "ku": st.floats(0, 30),
        }
    )
)
def test_whatever_is_accepted_fits_the_board_to_half_a_count(values: dict[str, float]) -> None:
    joint = {key: values[key] for key in GAINS} | {"sets": {key: values[key] for key in SETS}}
    raw = controller.Controller.model_validate({"joint": (joint,) * 4}).raw_values()
    for key, value in values.items():
        parameter = schema.PARAMETER_BY_NAME[f"joint3.{'ku_mv' if key == 'ku' else key.lower()}"]
        physical = value * 1000 if key == "ku" else value
        stored = raw[parameter.name]
        assert parameter.minimum <= stored <= parameter.maximum
        assert abs(parameter.to_physical(stored) - physical) <= parameter.lsb * 0.5000001
        if key in SETS:  # the firmware refuses flanks below 0.01 in its own counts
            assert abs(stored) >= 0.01 * 16384


left, right, gain = st.integers(-16384, -164), st.integers(164, 16384), st.integers(0, 64 << 16)
row = st.tuples(
    *(left, left, right, right), *(left, left, right, right), *(gain, gain), st.integers(0, 1000 << 16),
    st.integers(0, 30_000), st.integers(1, 20),
)  # fmt: skip


@given(rows=st.tuples(row, row, row, row))
def test_what_is_written_is_read_back_bit_for_bit(
    tmp_path_factory: pytest.TempPathFactory, rows: tuple[tuple[int, ...], ...]
) -> None:
    exact, path = np.array(rows, dtype=np.int32), tmp_path_factory.getbasetemp() / "any.toml"
    controller.save(path, exact, "any", header=("a line",), notes=("base yaw", "", "", ""), tuning={"seed": 1})
    loaded = toml_file.load(path, controller.Controller)
    np.testing.assert_array_equal(controller_row(loaded), exact)
    for number, joint in enumerate(loaded.joint):  # and no number of it is rounded
        for _, parameter, value in joint.parameters(number):
            raw = rows[number][CONTROLLER_COLUMNS.index(parameter.name.removeprefix(f"joint{number}."))]
            assert value == pytest.approx(parameter.to_physical(raw), rel=1e-15)


def test_a_file_with_its_origin_loads_and_still_refuses_unknown_keys(tmp_path: Path) -> None:
    path = tmp_path / "controller.toml"
    tuning = {"status": "complete", "seed": 3, "margin": [{"joint": 0, "kind": "rest"}, {"joint": 1, "kind": "rest"}]}
    controller.save(path, default_controller(), "a test", header=("first", ""), notes=("yaw",) * 4, tuning=tuning)
    assert path.read_text().startswith('# first\n#\nsource = "a test"\n\n[[joint]]  # 0: yaw\nkp = ')
    loaded = controller.load(path)
    assert (loaded.source, loaded.tuning) == ("a test", tuning)
    with pytest.raises(UserError, match="unknown key toning"):
        load(tmp_path, path.read_text().replace("[tuning]", "[toning]").replace("tuning.margin", "toning.margin"))


@pytest.mark.parametrize(
    ("column", "raw", "words"),
    [
        ("ze_c", 163, r"controller\.toml: joint\[1\]\.sets\.Ze_c is 0\.0099\d*, but it must be at least 0\.01"),
        ("ne_c", 5, r"joint\[1\]\.sets\.Ne_c is 0\.0003\d*, but it must be at least -1 and at most -0\.01"),
        ("kp", (64 << 16) + 1, r"joint1\.kp is 64.*out of range"),
        ("ku_mv", -1, r"joint1\.ku_mv is -1 mV, which is out of range"),
    ],
)
def test_what_a_board_would_refuse_is_never_written(tmp_path: Path, column: str, raw: int, words: str) -> None:
    rows = default_controller()
    rows[1, CONTROLLER_COLUMNS.index(column)] = raw
    with pytest.raises(UserError, match=words):
        controller.save(tmp_path / "controller.toml", rows)
    assert not list(tmp_path.iterdir())


def test_rows_that_are_not_whole_numbers_are_no_controller(tmp_path: Path) -> None:
    with pytest.raises(TypeError):
        controller.save(tmp_path / "controller.toml", default_controller() + 0.5)
