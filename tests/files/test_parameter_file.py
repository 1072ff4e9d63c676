"""A backup gives back exactly the parameters that went in."""

from __future__ import annotations

from pathlib import Path

import pytest
from hypothesis import HealthCheck, given, settings
from hypothesis import strategies as st

from greywhale.base.errors import UserError
from greywhale.files import parameter_file
from greywhale.protocol import schema
from greywhale.protocol.table import ParameterTable, physical
from tests.files.older_parameters import write_older


@st.composite
def tables(draw: st.DrawFn) -> tuple[int, ...]:
    """Raw values that the table's own rules accept."""
    values = []
    for parameter in schema.PARAMETERS:
        number = st.integers(parameter.minimum, parameter.maximum)
        values.append(draw(number.filter(bool) if parameter.nonzero else number))
    for parameter in schema.PARAMETERS:
        if parameter.below is not None:
            other = schema.PARAMETER_BY_NAME[f"{parameter.group}{parameter.element}.{parameter.below}"]
            values[parameter.index], values[other.index] = parameter.minimum, other.maximum
    return tuple(values)


@given(tables())
@settings(max_examples=30, suppress_health_check=[HealthCheck.too_slow, HealthCheck.function_scoped_fixture])
def test_every_raw_value_survives(tmp_path: Path, values: tuple[int, ...]) -> None:
    path = tmp_path / "backup.toml"
    table = ParameterTable(values)
    parameter_file.save(path, table)
    assert parameter_file.load(path) == table


def test_neighbouring_raw_values_stay_apart_at_the_ends_of_the_range() -> None:
    for one in schema.PARAMETERS:
        for raw in {one.minimum, one.minimum + 1, one.maximum - 1, one.maximum} - {0}:
            assert one.to_raw(physical(one, raw)) == raw


# What an older file lacks, by the layout that brought it.
NEWER = {"unrest_amplitude": 0, "joint2.ce_ticks": 9, "gravity_1": 5, "joint3.ratio": 32}


@pytest.mark.parametrize("layout", range(1, schema.LAYOUT))
def test_a_backup_of_an_older_layout_gets_the_defaults_of_what_it_lacks(tmp_path: Path, layout: int) -> None:
    path = tmp_path / "backup.toml"
    table = ParameterTable.defaults().with_raw({"joint1.kp": 50_000})
    newer = {name: raw for name, raw in NEWER.items() if schema.PARAMETER_BY_NAME[name].since > layout}
    write_older(path, table.with_raw(newer), layout)
    assert parameter_file.load(path) == table
    stated = parameter_file.load_stated(path)
    assert all(schema.PARAMETER_BY_NAME[name].since <= layout for name in stated)
    assert stated == {name: raw for name, raw in table.by_name().items() if name in stated}
    assert {*parameter_file.not_in(stated), *stated} == set(table.by_name())
    assert parameter_file.not_in(stated)


def test_a_backup_of_this_layout_states_everything(tmp_path: Path) -> None:
    path = tmp_path / "backup.toml"
    table = ParameterTable.defaults().with_raw(NEWER)
    parameter_file.save(path, table)
    assert parameter_file.load_stated(path) == table.by_name()
    assert parameter_file.not_in(table.by_name()) == ()


@pytest.mark.parametrize(
    ("old", "new", "words"),
    [
        ("period_ms = 1", "period_ms = 51", "period_ms is 51 ms, which is out of range"),
        ("period_ms = 1", "period_ms = 1.5", "period_ms is 1.5 ms, but it must be a whole number"),
        ("kp = 0.513", "kp = 1e-9", "joint0.kp is 1e-09 1/rad, which the board would store as 0"),
        ("period_ms = 1", "", "period_ms is missing"),
        ("unrest_rate = 6", "", "unrest_rate is missing"),
        ("period_ms = 1", "period_ms = 1\nperiod = 2", "unknown key period; perhaps period_ms is meant."),
        ("period_ms = 1", "period_ms = true", "period_ms is true, but it must be a number"),
        ("period_ms = 1", "period_ms = inf", "period_ms is inf"),
        ("period_ms = 1", "period_ms =", "not valid TOML"),
        ("limit_min = -2.5", "limit_min = 2.6", "joint0.limit_min is 2.6"),
    ],
)
def test_a_spoiled_backup_is_refused(tmp_path: Path, old: str, new: str, words: str) -> None:
    path = tmp_path / "backup.toml"
    parameter_file.save(path, ParameterTable.defaults())
    text = path.read_text()
    assert old in text
    path.write_text(text.replace(old, new, 1))
    with pytest.raises(UserError, match=f"^{path}: .*{words}"):
        parameter_file.load(path)
