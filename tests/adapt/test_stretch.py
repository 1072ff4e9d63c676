"""Samples become stretches on an even grid, and a gap parts them."""

from __future__ import annotations

import numpy as np

from greywhale.adapt.limits import ADAPTATION_LIMITS
from greywhale.adapt.stretch import ROWS, Collector, Stretch, chains_of, traces_of
from greywhale.board.stream import Received
from greywhale.protocol import schema
from greywhale.protocol.firmware import ANGLE_LSB

MAX_LOST = ADAPTATION_LIMITS.samples.max_lost_samples


def sample(tick: int, lost: int = 0) -> Received:
    """Joint j's leader is at (j + 1) counts a tick, its follower half a count behind; the voltage is the tick in mV."""
    leader = tick, 2 * tick, 3 * tick, 4 * tick
    follower = tick - 8, 2 * tick - 8, 3 * tick - 8, 4 * tick - 8
    volts = tick, tick, tick, tick
    made = schema.Sample(tick, schema.State.FOLLOWING, schema.Fault.NONE, leader, follower, volts)
    return Received(made, tick, lost)


def collect(ticks: list[int], lost: dict[int, int] | None = None) -> list[Stretch]:
    collector = Collector()
    found = [collector.take(sample(tick, (lost or {}).get(tick, 0))) for tick in ticks]
    return [one for one in found if one is not None]


def test_stretches_follow_each_other_without_a_gap() -> None:
    first, second = collect(list(range(5, 2 * ROWS + 6)))
    assert (first.joined, second.joined) == (False, True)
    assert (first.begins_s, second.begins_s) == (0.005, 1.005)
    whole = traces_of([first, second])
    np.testing.assert_allclose(whole.leader[:, 0], np.arange(5, 2 * ROWS + 5) * ANGLE_LSB)
    np.testing.assert_allclose(whole.voltage[:, 2], np.arange(5, 2 * ROWS + 5) * 1e-3)
    np.testing.assert_allclose(second.error, np.full(4, (8 * ANGLE_LSB) ** 2))


def test_a_few_lost_samples_lie_on_the_line_between_their_neighbours() -> None:
    ticks = [tick for tick in range(2 * ROWS + 1) if not 100 <= tick < 100 + MAX_LOST]
    first, second = collect(ticks, {100 + MAX_LOST: MAX_LOST})
    assert second.joined
    np.testing.assert_allclose(first.leader[:, 1], 2 * np.arange(ROWS) * ANGLE_LSB)


def test_many_lost_samples_part_stretches() -> None:
    ticks = [*range(ROWS + 200), *range(ROWS + 300, 4 * ROWS)]
    made = collect(ticks, {ROWS + 300: 100})
    assert [one.joined for one in made] == [False, False, True]
    assert [len(chain) for chain in chains_of(made)] == [1, 2]
    assert made[1].begins_s == (ROWS + 300) / 1000, "nothing of what came before the gap is in it"


def test_after_a_cut_a_stretch_begins_anew() -> None:
    collector = Collector()
    for tick in range(ROWS // 2):
        collector.take(sample(tick))
    collector.cut()
    made = [one for tick in range(2000, 2001 + ROWS) if (one := collector.take(sample(tick))) is not None]
    assert [(one.begins_s, one.joined) for one in made] == [(2.0, False)]
