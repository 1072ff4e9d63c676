"""Every update equation against steps worked out by hand, with the random numbers given."""

from __future__ import annotations

import math

import numpy as np
import pytest
from numpy.typing import ArrayLike

from greywhale.base.types import Floats
from greywhale.optimise import Box
from greywhale.optimise.grey_wolf import Draw, GreyWolf, GreyWolfWhale, GreyWolfWhaleAsPrinted, alpha_factor, hunt
from greywhale.optimise.shift_invariant import ShiftInvariantWolfWhale
from greywhale.optimise.swarm import Swarm, steer
from greywhale.optimise.whale import Whale, swim

BOX = Box([-10.0], [10.0])


class Scripted:
    """Random numbers that the test has written down: hands them out in order, and insists on the shapes asked for."""

    def __init__(self, *numbers: ArrayLike) -> None:
        self._numbers = [np.asarray(one, dtype=float) for one in numbers]

    def random(self, size: tuple[int, ...], /) -> Floats:
        assert self._numbers, f"the script has ended, but {size} more numbers are wanted"
        number = self._numbers.pop(0)
        assert number.ndim == 0 or number.shape == size, f"{size} wanted, the script has {number.shape}"
        return np.broadcast_to(number, size).copy()

    @property
    def used_up(self) -> bool:
        return not self._numbers


def column(*values: float) -> Floats:
    return np.array(values, dtype=float)[:, None]


# One wolf at 3, alpha at 2, beta at 4, delta at -1, a = 1.5:
#   A = 0.75, -0.75, 1.5 from r1;  Q = 1, 0.5, 2 from r2
#   |Q X - x| = |2 - 3|, |2 - 3|, |-2 - 3| = 1, 1, 5
LEADERS = column(2, 4, -1)
DRAW = Draw(np.array([[[0.75]], [[0.25]], [[1.0]]]), np.array([[[0.5]], [[0.25]], [[1.0]]]))


def test_spiral_multiplies_alphas_distance_by_rho_e_bl_cos_2_pi_l() -> None:
    # p = 0.5 is on the spiral's side of Eq. 9; l = 0.5 gives e^0.5 cos(pi) = -1.6487, so the distance turns negative.
    p, curl, gamma, rho = (np.array([one]) for one in (0.5, 0.5, 0.4, 0.5))
    factor = alpha_factor(p, curl, gamma, rho, 1.0)
    assert factor == pytest.approx([-0.5 * 1.6487212707001282])
    assert alpha_factor(p, 2 * curl, gamma, rho, 2.0) == pytest.approx([0.5 * math.e**2])
    moved = hunt(column(3), LEADERS, 1.5, DRAW, alpha=factor)
    assert moved == pytest.approx(column((2 + 0.75 * 0.8243606353500641 + 4.75 - 8.5) / 3))


def test_origin_and_weights_of_the_relative_form() -> None:
    # From 1: |1 - 2|, |0.5 * 3 - 2|, |2 * -2 - 2| = 1, 0.5, 6, so the targets are 1.25, 4.375, -10.
    moved = hunt(column(3), LEADERS, 1.5, DRAW, origin=np.array([1.0]), weights=(0.5, 0.3, 0.2))
    assert moved == pytest.approx(column(0.625 + 1.3125 - 2.0))


def test_gwo_woa_moves_a_whole_pack_as_worked_out() -> None:
    # Unit numbers 0.6, 0.7, 0.45 are 2, 4, -1, ranked in this order; a = 2, so r1 = 0.75 is A = 1; r2 = 0.5 is Q = 1.
    # p, then l = 2 * 0.5 - 1 = 0 (whose spiral is 1), then gamma, then rho.
    source = Scripted(column(0.6, 0.7, 0.45), 0.75, 0.5, [0.3, 0.3, 0.8], 0.5, [0.9, 0.5, 0.1], [0.2, 0.3, 0.5])
    optimiser = GreyWolfWhale(BOX, 9, source, pack=3)
    assert optimiser.ask() == pytest.approx(column(2, 4, -1))
    optimiser.tell([1, 2, 3])
    # At 2: (2 - 0, 4 - 2, -1 - 3); at 4: (2 - 0.5 * 2, 4 - 0, -1 - 5); at -1: (2 - 0.5 * 3, 4 - 5, -1 - 0)
    assert optimiser.ask() == pytest.approx(column(0, -1 / 3, -0.5))
    assert source.used_up


def test_gwo_draws_only_r1_and_r2() -> None:
    source = Scripted(column(0.6, 0.7, 0.45), 0.75, 0.5)
    optimiser = GreyWolf(BOX, 9, source, pack=3)
    optimiser.ask()
    optimiser.tell([1, 2, 3])
    # At 4 now (2 - 2, 4, -6), at -1 (2 - 3, 4 - 5, -1)
    assert optimiser.ask() == pytest.approx(column(0, -2 / 3, -1))
    assert source.used_up


@pytest.mark.parametrize(
    ("method", "expected"),
    [(GreyWolf, [2, 1.5, 1, 0.5]), (GreyWolfWhale, [2, 1.5, 1, 0.5]), (GreyWolfWhaleAsPrinted, [2, 1.75, 1.5, 1.25])],
)
def test_a_falls_over_the_moves(method: type[GreyWolf], expected: list[float]) -> None:
    # 10 x 5 evaluations: the first pack and four moves.
    optimiser = method(BOX, 50, np.random.default_rng(1), pack=10)
    optimiser.ask()
    optimiser.tell(np.arange(10.0))
    seen = []
    while not optimiser.done:
        seen.append(optimiser.a)
        optimiser.ask()
        optimiser.tell(np.arange(10.0))
    assert seen == pytest.approx(expected)


# With r1 = 0.5 all A are 0 and every wolf lands on the leaders' mean, which shows who they are.
@pytest.mark.parametrize(
    ("elitist", "second", "mean"),
    [
        (True, [7, 8, 9], (2 + 4 - 1) / 3),  # nothing better was found
        (True, [7, 1.5, 9], (2 - 1 / 3 + 4) / 3),  # the second wolf's new place comes between alpha and beta
        (False, [7, 8, 9], (0 - 1 / 3 - 0.5) / 3),  # the present pack, though worse
    ],
)
def test_elitist_leaders_are_the_best_ever_seen(elitist: bool, second: list[float], mean: float) -> None:
    move = (0.75, 0.5, [0.3, 0.3, 0.8], 0.5, [0.9, 0.5, 0.1], [0.2, 0.3, 0.5])
    source = Scripted(column(0.6, 0.7, 0.45), *move, 0.5, 0.5, 0.1, 0.5, 0.5, 0.5)
    optimiser = GreyWolfWhale(BOX, 9, source, pack=3, elitist=elitist)
    optimiser.ask()
    optimiser.tell([1, 2, 3])
    optimiser.ask()
    optimiser.tell(second)
    assert optimiser.ask() == pytest.approx(np.full((3, 1), mean))


def test_whale_encircles_the_prey_or_another_or_swims_the_spiral() -> None:
    # a = 1.5, r2 = 0.75 is C = 1.5. r1 = 0.75 is A = 0.75: 1 - 0.75 |1.5 - 3|. r1 = 0.9 is A = 1.2: 5 - 1.2 |7.5 - 3|.
    # p = 0.5: l = 0.5, |1 - 3| e^0.5 cos(pi) + 1.
    r = np.array([[0.75, 0.9, 0.9], [0.75, 0.75, 0.75], [0.49, 0.49, 0.5], [0.75, 0.75, 0.75]])
    moved = swim(column(3, 3, 3), np.array([1.0]), column(5, 5, 5), 1.5, r)
    assert moved == pytest.approx(column(-0.125, -0.4, 1 - 2 * 1.6487212707001282))


@pytest.mark.parametrize(("elitist", "prey"), [(True, 2.0), (False, 3.0)])
def test_whales_prey(elitist: bool, prey: float) -> None:
    # First pack 2, 8; then p = 0.9 with l = 0.25, whose cosine is 0: all whales land on the prey, here 2.
    onto_the_prey = ([[0.5, 0.5], [0.5, 0.5], [0.9, 0.9], [0.625, 0.625]], 0.0)
    # a = 4/3 makes A = -0.625 and -0.9375 of r1; r2 = 0.9 is C = 1.8, so 2 - A |3.6 - 2| = 3 and 3.5: off the prey.
    away = ([[0.265625, 0.1484375], [0.9, 0.9], [0.1, 0.1], [0.5, 0.5]], 0.0)
    # r1 = 0.5 is A = 0, encircling: again the prey itself.
    source = Scripted(column(0.6, 0.9), *onto_the_prey, *away, [[0.5, 0.5], [0.5, 0.5], [0.1, 0.1], [0.5, 0.5]], 0.0)
    optimiser = Whale(Box([-10.0], [10.0]), 8, source, pack=2, elitist=elitist)
    optimiser.ask()
    optimiser.tell([1, 2])
    assert optimiser.ask() == pytest.approx(column(2, 2))
    optimiser.tell([1, 1])
    assert optimiser.ask() == pytest.approx(column(3, 3.5))
    optimiser.tell([4, 6])
    assert optimiser.ask() == pytest.approx(column(prey, prey))
    assert source.used_up


def test_particle_is_pulled_to_its_own_best_and_the_swarms() -> None:
    velocity = steer(column(1), column(2), column(4), np.array([-1.0]), np.array([9.0]), column(0.5), column(0.25))
    assert velocity == pytest.approx(column(0.7298 + 1.49618 * (0.5 * 2 - 0.25 * 3)))
    limited = steer(column(1), column(2), column(4), np.array([-1.0]), np.array([0.5]), column(0.5), column(0.25))
    assert limited == pytest.approx(column(0.5))


def test_particle_at_the_bound_loses_its_velocity() -> None:
    # Places 9 and -9, best 9. The second starts towards the first with 0.9 * 1.49618 * 18 = 24.2, limited to 10.
    source = Scripted(column(0.95, 0.05), 0.0, 0.9, 0.0, 0.9, 0.0, 0.9)
    optimiser = Swarm(BOX, 8, source, pack=2)
    optimiser.ask()
    optimiser.tell([1, 2])
    assert optimiser.ask() == pytest.approx(column(9, 1))
    optimiser.tell([1, 2])
    # 7.298 + 0.9 * 1.49618 * 8 = 18.07, limited to 10, would lead to 11.
    assert optimiser.ask() == pytest.approx(column(9, 10))
    optimiser.tell([1, 2])
    # From rest it comes back at once: 0.9 * 1.49618 * -1.
    assert optimiser.ask() == pytest.approx(column(9, 10 - 1.346562))


# The relative form on [0, 1]: the first pack is 1/6, 1/2, 5/6 from the Latin hypercube's two draws.
FIRST = (column(0.1, 0.5, 0.9), 0.5)
# r1 = 0.6 is A = 0.7 with a = 3.5; Q = 1; p = 0.1 encircles with gamma = 0.6; nothing is kept; no bound is met.
MOVE = (0.6, 0.5, 0.1, 0.5, 0.6, 0.5, 0.9, 0.0, 0.5)


def relative(*numbers: object) -> ShiftInvariantWolfWhale:
    optimiser = ShiftInvariantWolfWhale(Box([0.0], [1.0]), 30, Scripted(*numbers), pack=3)  # type: ignore[arg-type]
    assert optimiser.ask() == pytest.approx(column(1 / 6, 1 / 2, 5 / 6))
    optimiser.tell([3, 1, 2])
    return optimiser


def test_relative_move_as_worked_out() -> None:
    # Alpha 1/2, beta 5/6, delta 1/6; the mean is 1/2.
    # At 1/6: 0.5 (1/2 - 0.7 * 0.6 / 3) + 0.3 (5/6 - 0.7 * 2/3) + 0.2 (1/6) = 0.18 + 0.11 + 0.0333
    # At 1/2: 0.5 (1/2) + 0.3 (5/6 - 0.7 / 3) + 0.2 (1/6 - 0.7 / 3) = 0.25 + 0.18 - 0.0133
    # At 5/6: 0.5 (1/2 - 0.7 * 0.6 / 3) + 0.3 (5/6) + 0.2 (1/6 - 0.7 * 2/3) = 0.18 + 0.25 - 0.06
    assert relative(*FIRST, *MOVE).ask() == pytest.approx(column(0.97 / 3, 1.25 / 3, 0.37))


def test_relative_wolf_stays_unless_the_new_place_is_better() -> None:
    # Then A = 0: every wolf lands on the weighted mean of the leaders.
    optimiser = relative(*FIRST, *MOVE, 0.5, 0.5, 0.1, 0.5, 0.6, 0.5, 0.9, 0.0, 0.5)
    optimiser.ask()
    optimiser.tell([3, 5, 0.5])  # equal is not better; worse; better
    # Pack 1/6 (3), 1/2 (1), 0.37 (0.5).
    assert optimiser.ask() == pytest.approx(np.full((3, 1), 0.5 * 0.37 + 0.3 / 2 + 0.2 / 6))


def test_relative_wolf_that_would_leave_goes_part_of_the_way_to_the_bound() -> None:
    # r1 = 0 is A = -3.5, outwards. At 1/2: 0.25 + 0.3 (5/6 + 3.5/3) + 0.2 (1/6 + 3.5/3) = 1.117, above 1.
    # At 1/6: 0.5 (1/2 + 3.5 * 0.2) + 0.3 (5/6 + 3.5 * 2/3) + 0.2 / 6 = 1.583
    # At 5/6: 0.5 (1/2 + 3.5 * 0.2) + 0.3 (5/6) + 0.2 (1/6 + 3.5 * 2/3) = 1.35
    part = column(0.25, 0.5, 0.75)
    optimiser = relative(*FIRST, 0.0, 0.5, 0.1, 0.5, 0.6, 0.5, 0.9, 0.0, part)
    assert optimiser.ask() == pytest.approx(column(1 - 0.25 * 5 / 6, 1 - 0.5 / 2, 1 - 0.75 / 6))
    # r1 = 1 is A = 3.5. At 1/6: 0.5 (1/2 - 3.5 * 0.2) + 0.3 (5/6 - 3.5 * 2/3) + 0.2 / 6 = -0.517, below 0.
    optimiser = relative(*FIRST, 1.0, 0.5, 0.1, 0.5, 0.6, 0.5, 0.9, 0.0, part)
    moved = optimiser.ask()
    assert moved[0] == pytest.approx(0.25 / 6)


def test_relative_wolf_keeps_coordinates_but_never_all() -> None:
    box = Box([0.0, 0.0], [1.0, 1.0])
    # Kept wherever the number is below 0.2; the wolf's own number chooses the one that changes all the same.
    kept = [[0.1, 0.1], [0.1, 0.3], [0.3, 0.3]]
    # r2 = 0.75, not the neutral 0.5, so that no wolf's move is zero by chance.
    source = Scripted(
        [[0.1, 0.1], [0.5, 0.5], [0.9, 0.9]], 0.5, 0.6, 0.75, 0.1, 0.5, 0.6, 0.5, kept, [0.9, 0.9, 0.1], 0.5
    )
    optimiser = ShiftInvariantWolfWhale(box, 30, source, pack=3)
    first = optimiser.ask()
    optimiser.tell([3, 1, 2])
    assert (optimiser.ask() == first).tolist() == [[True, False], [True, False], [False, False]]
