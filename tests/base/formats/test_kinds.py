"""Every kind of TOML file that greywhale writes or reads is known by its keys, also with faults in it."""

from __future__ import annotations

from typing import Any

import pytest

from greywhale.base.errors import UserError
from greywhale.base.formats.kinds import Kind, kind_of, refuse_other_kind


def test_answers_and_files_of_no_kind() -> None:
    assert kind_of({"name": "x", "supply_v": 12, "joint": [{"min_deg": -90}]}) is Kind.ANSWERS
    assert kind_of({"link": [{"length_mm": 100}]}) is Kind.ANSWERS
    for data in ({}, {"joint": 3}, {"joint": [1]}, {"period_ms": 1}, {"name": "x"}):
        assert kind_of(data) is None


def test_one_misspelt_key_does_not_hide_the_kind() -> None:
    assert kind_of({"joint": [{"kpp": 1.0, "kd": 0.1, "sets": {}}]}) is Kind.CONTROLLER
    assert kind_of({"links": [], "joint": [{"motor": {}}], "drive": {}}) is Kind.ARM


def test_only_other_kinds_are_refused() -> None:
    arm: dict[str, Any] = {"joint": [{"motor": {}}]}
    refuse_other_kind(arm, "f.toml", Kind.ARM, Kind.MODEL)
    refuse_other_kind({"anything": 1}, "f.toml", Kind.ARM)
    with pytest.raises(UserError, match=r"^f\.toml: this is an arm file, but a parameter file is needed here"):
        refuse_other_kind(arm, "f.toml", Kind.PARAMETERS)
