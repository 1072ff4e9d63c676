"""No number of a model can be edited unseen, and what is no number may be."""

from __future__ import annotations

import copy
import tomllib
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from greywhale.arm import ArmParameters
from greywhale.base.errors import UserError
from greywhale.base.formats import toml_file
from greywhale.files.arm import default_arm, load_arm
from greywhale.files.model import to_toml
from greywhale.tune.model import load_model
from greywhale.tune.model_checks import identification_of
from greywhale.tune.model_edits import UNSEALED, doubt_edits
from tests.support.arms import make_arm
from tests.tune.models import facts_of, write_model


def reasons(data: dict[str, Any]) -> str:
    """Why the content of a model is not taken; "" if it is."""
    try:
        arm = toml_file.check(data, ArmParameters, "model.toml")
        facts = identification_of(arm, "model.toml")
        assert facts is not None
        return " ".join(doubt.reason for doubt in doubt_edits(arm, facts))
    except UserError as error:
        return error.message


def numbers(table: Any, key: str = "") -> Iterator[tuple[str, Any, Any]]:
    """Every number of parsed TOML: its name, what it stands in and its place there."""
    for place, value in table.items() if isinstance(table, dict) else enumerate(table):
        name = f"{key}.{place}"
        if isinstance(value, dict | list):
            yield from numbers(value, name)
        elif isinstance(value, int | float):
            yield name, table, place


def test_every_number_of_a_model_is_sealed(tmp_path: Path) -> None:
    facts = facts_of(default_arm(), joints=(1,), parameters={"joint1.kp": 40_000})
    data = tomllib.loads(write_model(tmp_path / "model.toml", facts=facts).read_text(encoding="utf-8"))
    assert reasons(data) == ""
    found = list(numbers(data))
    assert {name.split(".")[1] for name, *_ in found} == {
        *("gravity", "link", "tip", "joint", "drive", "leader_pots", "follower_pots", "identification")
    }
    unseen = []
    for name, table, place in found:
        before = table[place]
        table[place] = before + 1 if isinstance(before, int) else before * (1.0 + 1e-12) + 1e-12
        if not reasons(data):
            unseen.append(name)
        table[place] = before
    assert unseen == []
    assert reasons(data) == ""


@pytest.mark.parametrize(
    ("old", "new", "table"),
    [
        ("mass = 0.21\n", "mass = 10.21\n", "link"),
        ('role = "validation"', 'role = "fit"', "identification"),
    ],
)
def test_an_edit_is_refused_with_its_table(tmp_path: Path, old: str, new: str, table: str) -> None:
    path = write_model(tmp_path / "model.toml")
    text = path.read_text(encoding="utf-8")
    assert old in text
    path.write_text(text.replace(old, new), encoding="utf-8")
    with pytest.raises(UserError, match=f": {table} in it was edited"):
        load_model(path)


def test_names_comments_and_order_may_be_edited(tmp_path: Path) -> None:
    path = write_model(tmp_path / "model.toml")
    data = tomllib.loads(path.read_text(encoding="utf-8"))
    turned = {key: data[key] for key in reversed(data)}
    turned |= {"name": "my arm", "source": "me"}
    turned["joint"][1]["name"] = "my shoulder"
    turned["link"][1] = dict(reversed(turned["link"][1].items()))
    assert reasons(turned) == ""
    path.write_text("# mine\n" + path.read_text(encoding="utf-8"), encoding="utf-8")
    assert load_model(path).doubts == ()


def test_a_table_of_another_model_is_found(tmp_path: Path) -> None:
    one, other = (
        tomllib.loads(write_model(tmp_path / f"{name}.toml", load_arm(name)).read_text(encoding="utf-8"))
        for name in ("default", "worn")
    )
    assert "follower_pots in it was edited" in reasons(copy.deepcopy(one) | {"follower_pots": other["follower_pots"]})
    assert "identified (joint" in reasons(copy.deepcopy(one) | {"identification": other["identification"]})


def test_a_model_of_before_the_seals_is_taken_and_said_to_be_unchecked(tmp_path: Path) -> None:
    arm = default_arm()
    path = tmp_path / "model.toml"
    path.write_text(to_toml(arm, facts_of(arm)), encoding="utf-8")
    assert load_model(path).doubts == (UNSEALED,)


def test_a_gap_of_next_to_nothing_is_none(tmp_path: Path) -> None:
    arm = make_arm(every_joint={"gear": {"half_gap": 0.0}})
    facts = facts_of(arm)
    gap = {"name": "joint2.gap", "unit": "rad", "value": 5e-10, "standard_deviation": 1e-3}
    covariance = np.zeros((len(facts["parameter"]) + 1,) * 2)
    covariance[:-1, :-1], covariance[-1, -1] = facts["covariance"], 1e-6
    facts |= {"parameter": [*facts["parameter"], gap], "covariance": covariance.tolist()}
    assert not load_model(write_model(tmp_path / "model.toml", arm, facts)).doubts
