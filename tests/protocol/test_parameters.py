"""The parameter table: order, ranges, units and CRC, the same on the host as in the firmware."""

from __future__ import annotations

import math
import tomllib
from typing import TYPE_CHECKING

import pytest
from hypothesis import given
from hypothesis import strategies as st

from greywhale.base.errors import UserError
from greywhale.protocol.declared import Parameter
from greywhale.protocol.schema import (
    DEFAULTS,
    PARAMETER_BY_NAME,
    PARAMETERS,
    TABLE,
    check_parameters,
    pack_parameters,
    param_crc,
    unpack_parameters,
)
from tools import ROOT

if TYPE_CHECKING:
    from .conftest import Firmware


def raw_values(parameter: Parameter) -> st.SearchStrategy[int]:
    values = st.integers(parameter.minimum, parameter.maximum)
    return values.filter(bool) if parameter.nonzero else values


tables = st.tuples(*map(raw_values, PARAMETERS))


def test_defaults_are_the_golden_bytes(firmware: Firmware) -> None:
    golden = tomllib.loads((ROOT / "shared/link/golden.toml").read_text(encoding="utf-8"))["parameters"]
    assert pack_parameters(DEFAULTS) == bytes.fromhex(golden["defaults"]) == firmware.defaults()
    assert param_crc(DEFAULTS) == golden["crc"]
    check_parameters(DEFAULTS)


def test_the_default_potentiometer_turns_300_degrees() -> None:
    scale = PARAMETER_BY_NAME["leader0.scale"]
    assert scale.to_physical(scale.default) * 16368 == pytest.approx(math.radians(300), rel=1e-4)


@given(tables)
def test_both_sides_pack_and_sum_alike(firmware: Firmware, raw: tuple[int, ...]) -> None:
    table = firmware.defaults()
    for parameter, value in zip(PARAMETERS, raw, strict=True):
        assert firmware.set(table, parameter.index, value) == "ok"
    assert bytes(table) == pack_parameters(raw)
    assert unpack_parameters(bytes(table)) == raw
    assert tuple(firmware.get(table, parameter.index) for parameter in PARAMETERS) == raw
    assert firmware.crc(table) == param_crc(raw)


def test_both_sides_draw_the_ranges_alike(firmware: Firmware) -> None:
    for parameter in PARAMETERS:
        low, high = parameter.minimum, parameter.maximum
        for value in (low, high, low - 1, high + 1, 0, -(2**31), 2**31 - 1):
            accepted = firmware.set(firmware.defaults(), parameter.index, value)
            if low <= value <= high and (value or not parameter.nonzero):
                assert accepted == "ok"
                parameter.check_raw(value)
            else:
                assert accepted == "out_of_range"
                with pytest.raises(UserError, match=parameter.name):
                    parameter.check_raw(value)


@pytest.mark.slow
@given(tables)
def test_both_sides_find_the_same_contradictions(firmware: Firmware, raw: tuple[int, ...]) -> None:
    invalid = firmware.first_invalid(bytearray(pack_parameters(raw)))
    if invalid is None:
        check_parameters(raw)
    else:
        with pytest.raises(UserError, match=PARAMETERS[invalid].name):
            check_parameters(raw)


@given(st.sampled_from(PARAMETERS), st.data())
def test_raw_to_physical_and_back(parameter: Parameter, data: st.DataObject) -> None:
    raw = data.draw(raw_values(parameter))
    assert parameter.to_raw(parameter.to_physical(raw)) == raw


@given(st.sampled_from([p for p in PARAMETERS if not p.nonzero]), st.floats(0, 1))
def test_to_raw_takes_the_nearest(parameter: Parameter, share: float) -> None:
    low, high = parameter.to_physical(parameter.minimum), parameter.to_physical(parameter.maximum)
    physical = min(max(low + share * (high - low), low), high)
    assert abs(parameter.to_physical(parameter.to_raw(physical)) - physical) <= parameter.lsb * 0.5000001


def test_contradicting_limits_are_named() -> None:
    raw = list(DEFAULTS)
    raw[PARAMETER_BY_NAME["joint2.limit_min"].index] = 4096
    raw[PARAMETER_BY_NAME["joint2.limit_max"].index] = 4096
    with pytest.raises(UserError, match=r"joint2\.limit_min is 1 and joint2\.limit_max is 1 rad; choose .* below"):
        check_parameters(raw)


def test_a_set_that_is_not_whole_is_refused() -> None:
    with pytest.raises(UserError, match=f"{len(DEFAULTS)} values, but {len(DEFAULTS) - 1}"):
        param_crc(DEFAULTS[:-1])
    with pytest.raises(UserError, match=f"{TABLE.size} bytes, but 198"):
        unpack_parameters(bytes(198))
