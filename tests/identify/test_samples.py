"""Plants drawn from an identified arm's covariance: which, how spread, how repeatable."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from greywhale.arm import ArmParameters
from greywhale.arm.plants import PLANT_COLUMNS, check_plants, column, columns
from greywhale.base.errors import UserError
from greywhale.files.arm import load_arm
from greywhale.identify import IdentificationResult, loosen_gears, sampled_plants
from greywhale.identify.found_model import Rival
from greywhale.identify.space import Space
from greywhale.loop import plant_row

# More doubt does not come from masses and lengths: of a torque, and of volts, which hardly hang on them.
LINKS_SHARE, VOLTS_SHARE = 0.1, 0.01


@pytest.fixture(scope="module")
def model(outcome: IdentificationResult, tmp_path_factory: pytest.TempPathFactory) -> ArmParameters:
    """Without rivals, which take the place of draws."""
    path = tmp_path_factory.mktemp("model") / "model.toml"
    replace(outcome, found=replace(outcome.found, rivals=())).save(path)
    return load_arm(path)


@pytest.mark.slow
def test_row_0_is_the_estimate_and_no_row_depends_on_how_many_there_are(model: ArmParameters) -> None:
    plants = sampled_plants(model, 9, seed=4)
    assert plants.shape == (9, len(plant_row(model)))
    np.testing.assert_array_equal(plants[0], plant_row(model))
    np.testing.assert_array_equal(sampled_plants(model, 3, seed=4), plants[:3])
    np.testing.assert_array_equal(sampled_plants(model, 1), plants[:1])
    assert not np.array_equal(sampled_plants(model, 9, seed=5)[1:], plants[1:])


@pytest.mark.slow
def test_every_drawn_plant_is_one_that_an_arm_can_have(model: ArmParameters) -> None:
    """With a covariance a hundred times wider too, so that gaps and shares would come out negative."""
    facts = model.identification
    assert facts is not None
    wide = facts | {"covariance": (100.0 * np.array(facts["covariance"])).tolist()}
    for arm in (model, model.model_copy(update={"identification": wide})):
        plants = sampled_plants(arm, 200)
        np.testing.assert_array_equal(check_plants(plants), plants)
        assert len(np.unique(plants, axis=0)) == 200


@pytest.mark.slow
def test_draws_have_the_covariance_of_the_file(model: ArmParameters, outcome: IdentificationResult) -> None:
    """Of the logarithms that no range cuts, taken back out of the plants."""
    plants = sampled_plants(model, 4000)
    columns = Space.of(model, ("alpha", "inertia", "damping"), range(4))
    taken, expected = [], []
    names = [one.name for one in outcome.estimates]
    assert outcome.found.covariance is not None
    assert outcome.found.covariance.shape == (len(names), len(names))
    for parameter in columns.parameters:
        torque = np.log(plants[:, column("torque_per_volt", parameter.joint)])
        if parameter.kind == "alpha":
            taken.append(-torque)
        else:
            taken.append(np.log(plants[:, column(parameter.kind, parameter.joint)]) - torque)
        index = names.index(parameter.name)
        expected.append(index)
        drawn, read = np.sqrt(outcome.found.covariance[index, index]), outcome.estimates[index]
        assert read.deviation is not None
        assert drawn * read.value < 1.0001 * read.deviation, "people read the doubt about masses and lengths, too"
        links = LINKS_SHARE if parameter.kind == "alpha" else VOLTS_SHARE
        assert read.deviation < 1.25 * read.value * np.hypot(np.std(taken[-1]), links)
    wanted = outcome.found.covariance[np.ix_(expected, expected)]
    scale = np.sqrt(np.diag(wanted))
    np.testing.assert_allclose(
        np.cov(np.array(taken)) / np.outer(scale, scale), wanted / np.outer(scale, scale), atol=0.1
    )


@pytest.mark.slow
def test_looser_gears_have_wider_gaps_and_softer_teeth_and_nothing_else_changes(model: ArmParameters) -> None:
    estimate, loose = (loosen_gears(model, deviations) for deviations in (0.0, 1.0))
    other = {PLANT_COLUMNS[place].split(".")[1] for place in np.flatnonzero(loose != estimate)}
    assert other == {"half_gap", "stiffness", "mesh_damping"}
    assert (loose[columns("half_gap")] > estimate[columns("half_gap")]).all()
    softer = loose[columns("stiffness")] / estimate[columns("stiffness")]
    assert (softer < 1.0).all()
    np.testing.assert_allclose(loose[columns("mesh_damping")] / estimate[columns("mesh_damping")], softer)
    bare = load_arm("white_box")
    np.testing.assert_array_equal(loosen_gears(bare, 1.0), plant_row(bare))


def test_a_joint_without_teeth_gets_the_loosest_ones_of_its_rivals() -> None:
    other = plant_row(load_arm("default"))
    softer = other.copy()
    softer[columns("stiffness") + columns("mesh_damping")] /= 2.0
    alpha = {"name": "joint0.alpha", "value": 5.0}
    rivals = [{"order": "backlash", "plant": rival.tolist()} for rival in (other, softer)]
    facts = {"parameter": [alpha], "covariance": [[0.01]], "rival": rivals}
    loose = loosen_gears(load_arm("white_box").model_copy(update={"identification": facts}), 1.0)
    gear = columns("half_gap") + columns("stiffness") + columns("mesh_damping")
    np.testing.assert_array_equal(loose[gear], softer[gear])
    assert loose[column("torque_per_volt", 0)] == pytest.approx(0.2)


@pytest.mark.slow
def test_an_arm_without_a_covariance_and_a_wrong_count_are_refused(model: ArmParameters) -> None:
    with pytest.raises(UserError, match="at least 1") as refused:
        sampled_plants(model, 0)
    assert refused.value.exit_code == 2
    bare = load_arm("white_box")
    np.testing.assert_array_equal(sampled_plants(bare, 1), plant_row(bare)[None])
    with pytest.raises(UserError, match="no \\[identification\\] with a covariance"):
        sampled_plants(bare, 2)
    facts = model.identification
    assert facts is not None
    cut = model.model_copy(update={"identification": facts | {"covariance": [[1.0]]}})
    with pytest.raises(UserError, match=r"shape \(1, 1\), but there are \d+ parameter tables"):
        sampled_plants(cut, 2)
    renamed = [table | {"name": "joint9.magic"} for table in facts["parameter"]]
    strange = model.model_copy(update={"identification": facts | {"parameter": renamed}})
    with pytest.raises(UserError, match="'joint9.magic'"):
        sampled_plants(strange, 2)


@pytest.mark.slow
def test_rivals_take_every_third_row_and_the_draws_between_stay(
    model: ArmParameters, outcome: IdentificationResult, tmp_path_factory: pytest.TempPathFactory
) -> None:
    other = plant_row(load_arm("worn"))
    rivals = (Rival("backlash", 0.9, other), Rival("creep", 0.9, 2.0 * other))
    path = tmp_path_factory.mktemp("model") / "model.toml"
    told = replace(outcome, found=replace(outcome.found, rivals=rivals))
    told.save(path)
    assert "Nearly as good: backlash; creep." in told.text()
    plants, plain = sampled_plants(load_arm(path), 8), sampled_plants(model, 8)
    np.testing.assert_array_equal(plants[3], other)
    np.testing.assert_array_equal(plants[6], 2.0 * other)
    kept = [0, 1, 2, 4, 5, 7]
    np.testing.assert_array_equal(plants[kept], plain[kept])
    facts = model.identification
    assert facts is not None
    short = model.model_copy(update={"identification": facts | {"rival": [{"order": "creep", "plant": [1.0]}]}})
    with pytest.raises(UserError, match=f"a rival of .* has no plant of {len(other)} numbers"):
        sampled_plants(short, 4)
