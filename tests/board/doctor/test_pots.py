"""Potentiometers at rest: each thing that a person must mend is told apart from what is harmless."""

from __future__ import annotations

import numpy as np
import pytest

from greywhale.board.doctor.finding import Finding, Verdict
from greywhale.board.doctor.pots import examine_pots, look

ROWS = 2000
TIME_S = 0.001 * np.arange(ROWS)
WHERE = (300.0, 420.0, 515.0, 610.0, 350.0, 470.0, 560.0, 700.0)


def resting(noise: float = 0.3, seed: int = 1) -> np.ndarray:
    random = np.random.default_rng(seed)
    counts: np.ndarray = np.array(WHERE) + random.normal(0.0, noise, (ROWS, 8))
    return counts


def verdicts(counts: np.ndarray, rails: list[str] | None = None) -> dict[str, Finding]:
    return {one.check: one for one in examine_pots(counts, rails or [])}


def bad(found: dict[str, Finding]) -> set[str]:
    return {name for name, one in found.items() if one.verdict is not Verdict.GOOD}


@pytest.mark.parametrize("seed", [1, 2])
def test_a_sound_arm_at_rest_is_good_in_every_way(seed: int) -> None:
    assert bad(verdicts(resting(0.5, seed))) == set()


def test_a_loose_contact_is_told_by_its_jumps_and_nothing_else_is() -> None:
    counts = resting()
    counts[200:203, 5] += 40.0
    counts[900:902, 5] -= 25.0
    found = verdicts(counts)
    assert bad(found) == {"contacts"}
    assert found["contacts"].verdict is Verdict.BAD
    assert "follower potentiometer 1 2 times" in found["contacts"].says


@pytest.mark.parametrize("hertz", [50.0, 60.0])
def test_hum_is_told_with_its_frequency(hertz: float) -> None:
    counts = resting()
    counts[:, 2] += 3.0 * np.sin(2 * np.pi * hertz * TIME_S)
    assert look(counts[:, 2]).hum_counts == pytest.approx(3.0, rel=0.05)
    found = verdicts(counts)
    assert "hum" in bad(found)
    assert f"at {hertz:g} Hz" in found["hum"].says
    assert "leader potentiometer 2" in found["hum"].says
    assert "leader potentiometer 1" not in found["hum"].says


@pytest.mark.parametrize(("noise", "verdict"), [(1.0, Verdict.GOOD), (2.5, Verdict.NOTE), (6.0, Verdict.BAD)])
def test_noise_has_two_limits(noise: float, verdict: Verdict) -> None:
    counts = resting()
    counts[:, 7] = WHERE[7] + np.random.default_rng(3).normal(0.0, noise, ROWS)
    assert verdicts(counts)["noise"].verdict is verdict


def test_an_arm_that_somebody_moves_is_not_called_noisy() -> None:
    counts = resting()
    counts[:, 0] += 30.0 * np.sin(2 * np.pi * 0.7 * TIME_S)
    found = verdicts(counts)
    assert bad(found) == {"at rest"}
    assert found["at rest"].verdict is Verdict.NOTE
    assert found["at rest"].says.startswith("Leader potentiometer 0 moved by up to")


def test_an_open_input_that_keeps_its_neighbours_charge_is_told() -> None:
    counts = resting()
    counts[:, 4] = counts[:, 3] + np.random.default_rng(4).normal(0.0, 0.1, ROWS)
    found = verdicts(counts)
    assert bad(found) == {"inputs"}
    assert "leader potentiometer 3 and follower potentiometer 0" in found["inputs"].says


def test_two_that_stand_alike_but_wander_apart_are_two() -> None:
    counts = resting()
    counts[:, 4] += WHERE[3] - WHERE[4]
    assert bad(verdicts(counts)) == set()


def test_common_noise_alone_does_not_make_two_one() -> None:
    counts = resting() + np.random.default_rng(5).normal(0.0, 0.9, (ROWS, 1))
    assert bad(verdicts(counts)) == set()


def test_rails_are_passed_on() -> None:
    found = verdicts(resting(), ["leader potentiometer 1 reads 0..0 of 1023, at a rail (pot_low): check it."])
    assert found["rails"].verdict is Verdict.BAD
    assert found["rails"].says.startswith("Leader potentiometer 1 reads 0..0")


def test_jumps_do_not_count_as_noise() -> None:
    counts = resting()[:, 0]
    counts[500] += 300.0
    assert look(counts).noise_counts < 0.6
    assert look(counts).jumps == 1
