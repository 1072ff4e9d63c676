"""Which models are tuned for, which are refused and in which words, and which plants stand for them."""

from __future__ import annotations

import hashlib
import re
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from greywhale.arm.plants import columns
from greywhale.base.errors import FAILED, UserError
from greywhale.files import parameter_file
from greywhale.files.arm import default_arm, load_arm
from greywhale.files.model import to_toml
from greywhale.identify import loosen_gears, sampled_plants
from greywhale.loop import default_controller, plant_row
from greywhale.protocol.table import ParameterTable
from greywhale.tune.limits import TUNING_LIMITS
from greywhale.tune.model import load_model
from tests.tune.models import SEARCHED, facts_of, log_facts, write_model


def table(**changes: int) -> ParameterTable:
    """The firmware's defaults, but for some raw values (`joint0__kp` for joint0.kp)."""
    return ParameterTable.defaults().with_raw({name.replace("__", "."): raw for name, raw in changes.items()})


def refused(path: Path, **options: Any) -> str:
    """The sentence of a refusal, which --force must turn into a doubt of the model."""
    with pytest.raises(UserError) as caught:
        load_model(path, **options)
    assert caught.value.exit_code == FAILED
    sentence = caught.value.message
    assert sentence.startswith(f"{path}: ")
    assert "or go on with --force" in sentence
    reason = sentence.removeprefix(f"{path}: ").partition("; ")[0]
    assert f"{reason}." in load_model(path, force=True, **options).doubts
    return sentence


# --- good models ----------------------------------------------------------------------------------------------------


def test_a_validated_model_has_no_doubts_and_is_its_arm(tmp_path: Path) -> None:
    path = write_model(tmp_path / "model.toml")
    model = load_model(path)
    assert (model.doubts, model.file) == ((), str(path))
    assert model.table == ParameterTable.defaults()
    assert model.digest == hashlib.sha256(path.read_bytes()).hexdigest()
    np.testing.assert_array_equal(model.controllers, default_controller())
    np.testing.assert_allclose(model.plants[0], plant_row(default_arm()), rtol=1e-12)


def test_plants_are_drawn_from_the_covariance_and_follow_from_the_seed(tmp_path: Path) -> None:
    path = write_model(tmp_path / "model.toml")
    model = load_model(path, samples=5, seed=3)
    np.testing.assert_array_equal(np.delete(model.plants, 1, axis=0), sampled_plants(load_arm(path), 5, 3))


def test_the_second_plant_has_looser_gears(tmp_path: Path) -> None:
    path = write_model(tmp_path / "model.toml", searched=(*SEARCHED, "gap", "teeth"))
    loose = load_model(path).plants[1]
    np.testing.assert_array_equal(loose, loosen_gears(load_arm(path), TUNING_LIMITS.model.gear_sigmas))
    assert (loose[columns("half_gap")] > plant_row(load_arm(path))[columns("half_gap")]).all()


def test_the_table_is_that_of_the_logs(tmp_path: Path) -> None:
    changed = {"joint0.kp": 40_000, "filter_shift": 2}
    model = load_model(write_model(tmp_path / "model.toml", parameters=changed))
    assert model.table == table(joint0__kp=40_000, filter_shift=2)
    assert model.controllers[0, 8] == 40_000
    assert model.period_ms == 1


def test_a_model_without_table_whose_logs_name_the_defaults_has_the_defaults(tmp_path: Path) -> None:
    crc = f"0x{ParameterTable.defaults().crc:04x}"
    logs = [log_facts(parameter_crc=crc), log_facts("validation")]
    model = load_model(write_model(tmp_path / "model.toml", parameters=None, log=logs))
    assert model.table == ParameterTable.defaults()


def test_a_backup_of_the_board_comes_before_the_logs(tmp_path: Path) -> None:
    backup = tmp_path / "backup.toml"
    parameter_file.save(backup, table(joint1__kp=50_000, joint2__limit_max=4096, soft_start_ms=500))
    model = load_model(write_model(tmp_path / "model.toml", parameters={"joint1.kp": 1}), params=backup)
    assert model.table == parameter_file.load(backup)
    assert not model.doubts


def test_a_model_as_good_as_a_good_arm_file_is_taken(tmp_path: Path) -> None:
    """Of an arm that was known already, identified once more or exact, noise decides which model is nearer. A model of
    before, which does not state chance, must not be worse at all.
    """
    logs = [log_facts(), log_facts("validation", -0.09), log_facts("validation, changed controller", 0.0)]
    assert load_model(write_model(tmp_path / "model.toml", log=logs)).doubts == ()
    worse = [log_facts(), log_facts("validation", -0.09, chance_rad2=0.8e-3)]
    assert "worse than the arm file it began with" in refused(write_model(tmp_path / "worse.toml", log=worse))
    old = [log_facts(), log_facts("validation", -0.01)]
    del old[1]["chance_rad2"]
    assert "worse than the arm file" in refused(write_model(tmp_path / "old.toml", log=old))


def test_warnings_of_the_identification_go_along(tmp_path: Path) -> None:
    warning = "fit.csv: joint 0 was at full voltage 60 % of the time; slower motion would tell more."
    assert load_model(write_model(tmp_path / "model.toml", warnings=[warning])).doubts == (warning,)


# --- refusals -------------------------------------------------------------------------------------------------------


@pytest.mark.parametrize(
    ("changes", "words"),
    [
        ({"status": "unfinished"}, '"unfinished"'),
        ({"log": [log_facts()]}, "validated on a second log"),
        ({"log": [log_facts(), log_facts("validation", -0.5)]}, r"validation\.csv .*\(0\.015 against 0\.01 rad²\)"),
        (
            {"log": [log_facts(), log_facts("validation"), log_facts("validation, changed controller", -0.2)]},
            r"\(0\.012 against 0\.01 rad²\), .* its controller, not the arm; fit that log too",
        ),
        ({"covariance": None, "method": "paper"}, "how uncertain .*method paper"),
        ({"joints": (0, 1, 3)}, r"no motor moved joint 2 \(wrist pitch\) in its logs"),
        ({"parameters": {"supply_mv": 12_000}}, "drive.supply is 15 V, .*supply_mv says 12 V"),
        ({"parameters": {"period_ms": 5}}, "1 ms, .* 5 ms"),
        (
            {"parameters": {"follower1.scale": 8_000}},
            r"potentiometer 1 turns 5\.24 rad .*follower1\.scale makes it 3\.9",
        ),
        ({"parameters": None}, "parameter table .*greywhale params"),
    ],
)
def test_a_doubtful_model_is_refused_with_the_reason(tmp_path: Path, changes: dict[str, Any], words: str) -> None:
    sentence = refused(write_model(tmp_path / "model.toml", **changes))
    assert re.search(words, sentence), sentence
    assert "more reason" not in sentence


def test_a_bare_arm_file_is_no_model_but_can_be_forced(tmp_path: Path) -> None:
    path = tmp_path / "arm.toml"
    path.write_text(to_toml(default_arm(), {}).replace("[identification]", ""), encoding="utf-8")
    assert "an arm file, not a model" in refused(path)
    assert load_model(path, force=True).plants.shape == (1, len(plant_row(default_arm())))


def test_a_shipped_arm_can_be_forced_by_its_name_at_its_own_supply() -> None:
    model = load_model("grey_box", force=True)
    assert model.arm == load_arm("grey_box")
    assert model.table["supply_mv"] == round(1000 * model.arm.drive.supply)
    assert len(model.digest) == 64


@pytest.mark.parametrize(
    ("joint", "guilty", "motion"),
    [
        ("2 (wrist pitch)", "damping", "move at a steady speed"),
        ("1 (shoulder pitch)", "coulomb", "move slowly to and fro"),
    ],
)
def test_too_uncertain_names_the_number_its_size_and_the_motion_that_settles_it(
    tmp_path: Path, joint: str, guilty: str, motion: str
) -> None:
    facts = facts_of(default_arm(), 0.01)
    (index,) = (n for n, one in enumerate(facts["parameter"]) if one["name"] == f"joint{joint[0]}.{guilty}")
    facts["covariance"][index][index] = 1.5**2
    facts["parameter"][index]["standard_deviation"] = 1.5 * facts["parameter"][index]["value"]
    sentence = refused(write_model(tmp_path / "model.toml", facts=facts))
    value = facts["parameter"][index]["value"]
    for words in (f"joint {joint} is too uncertain", f"{guilty} is {value:.2g} +- {1.5 * value:.2g} V", motion):
        assert words in sentence


def test_a_number_that_no_motion_feels_may_be_uncertain(tmp_path: Path) -> None:
    facts = facts_of(default_arm(), 0.01)
    names = [one["name"] for one in facts["parameter"]]
    direction = np.zeros(len(names))
    # The wrist roll carries next to nothing: twice the torque per volt against twice the inertia moves it alike.
    direction[names.index("joint3.alpha")] = 1.0
    facts["covariance"] = (np.array(facts["covariance"]) + 0.7**2 * np.outer(direction, direction)).tolist()
    assert not load_model(write_model(tmp_path / "model.toml", facts=facts)).doubts


def test_a_model_of_another_arm_is_found(tmp_path: Path) -> None:
    path, arm = write_model(tmp_path / "model.toml"), tmp_path / "arm.toml"
    arm.write_text(to_toml(default_arm(), {}).replace("mass = 0.13\n", "mass = 0.5\n"), encoding="utf-8")
    assert f"{arm}: link[1].mass is 0.13 here and 0.5 there" in refused(path, arm=arm)


@pytest.mark.parametrize(
    ("changes", "words"),
    [
        ({"filter_shift": 3}, "filter_shift was 1 and is 3; record"),
        ({"leader2__zero": 8000}, "leader2.zero was 8184 count14 and is 8000 count14; record"),
    ],
)
def test_a_board_that_is_not_that_of_the_logs_is_found(tmp_path: Path, changes: dict[str, int], words: str) -> None:
    backup = tmp_path / "backup.toml"
    parameter_file.save(backup, table(**changes))
    assert f"{backup}: {words}" in refused(write_model(tmp_path / "model.toml"), params=backup)


def test_of_several_reasons_the_gravest_is_told_and_the_others_counted(tmp_path: Path) -> None:
    path = write_model(tmp_path / "model.toml", status="unfinished", log=[log_facts()], parameters={"supply_mv": 9000})
    sentence = refused(path)
    assert '"unfinished"' in sentence
    assert "(2 more reasons" in sentence
    assert len(load_model(path, force=True).doubts) == 3


# --- broken files ---------------------------------------------------------------------------------------------------


@pytest.mark.parametrize(
    ("changes", "words"),
    [
        ({"status": None}, "identification.status: field required"),
        ({"log": [log_facts() | {"improvement": "much"}]}, "identification.log.0.improvement:"),
        ({"parameters": {"kp": 1}}, "identification.parameters: kp"),
        ({"parameters": {"period_ms": 99}}, "identification.parameters: period_ms is 99 ms"),
    ],
)
def test_a_broken_table_is_refused_even_with_force(tmp_path: Path, changes: dict[str, Any], words: str) -> None:
    path = write_model(tmp_path / "model.toml", **changes)
    with pytest.raises(UserError, match=f"^{path}: {words}"):
        load_model(path, force=True)
