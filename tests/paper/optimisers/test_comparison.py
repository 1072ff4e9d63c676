"""Comparisons: the same result however it is computed, ranks and statements that follow from the costs."""

from __future__ import annotations

import csv
import os
import select
import subprocess
import sys
from pathlib import Path

import matplotlib.pyplot as plt
import numpy as np
import pytest

from greywhale.base.errors import UserError
from greywhale.optimise.methods import METHODS
from greywhale.pictures.page import style
from greywhale_paper.optimisers.comparison import Comparison, Duel, Plan, compare, run_once
from greywhale_paper.optimisers.comparison_report import as_dict, statement, text, write_report
from greywhale_paper.optimisers.functions import SETTINGS
from greywhale_paper.pictures.ranks import plot_ranks
from tests.pictures.sight import faults
from tests.support.sentences import names

SMALL = Plan(("sphere", "ackley"), SETTINGS, ("gwo-woa", "de", "cma-es"), dimensions=3, budget=60, runs=4, seed=7)


@pytest.fixture(scope="module")
def small() -> Comparison:
    return compare(SMALL)


ENDLESS = """
from greywhale_paper.optimisers.comparison import Plan, compare
from greywhale.base.study import LocalWorkers
if __name__ == "__main__":
    plan = Plan(("sphere",), ("shifted",), ("pso",), dimensions=2, budget=3000, runs=100_000)
    compare(plan, LocalWorkers(2), lambda what, fraction: print(fraction, flush=True))
"""


@pytest.mark.slow
def test_processes_end_with_a_parent_that_is_killed(tmp_path: Path) -> None:
    script = tmp_path / "endless.py"
    script.write_text(ENDLESS)
    with subprocess.Popen([sys.executable, str(script)], stdout=subprocess.PIPE) as parent:
        assert parent.stdout is not None
        assert parent.stdout.readline() == b"0.0\n"
        assert parent.stdout.readline(), "the processes work"
        children = Path(f"/proc/{parent.pid}/task/{parent.pid}/children").read_text().split()
        handles = [os.pidfd_open(int(child)) for child in children]
        parent.kill()
        assert len(handles) >= 2
        for handle in handles:
            assert select.select([handle], [], [], 30.0)[0], "it has ended"
            os.close(handle)


def test_runs_split_into_parts_are_the_runs_in_their_order() -> None:
    # 3000 evaluations a run: a part holds one.
    plan = Plan(("sphere",), ("shifted",), ("pso",), dimensions=2, budget=3000, runs=3)
    costs = compare(plan).of("sphere", "shifted", "pso")
    assert costs.tolist() == [run_once(plan, "sphere", "shifted", "pso", run) for run in range(3)]
    assert len(set(costs)) == 3


def made_up() -> Comparison:
    """Two functions, three methods, six runs; on plain functions gwo leads, on shifted ones it comes last."""
    plan = Plan(("sphere", "ackley"), ("plain", "shifted"), ("gwo", "de", "pso"), runs=6)
    costs = np.empty((2, 2, 3, 6))
    runs = np.arange(6.0)
    costs[:, 0] = np.stack([runs, 10 + runs, 20 + runs])
    costs[:, 1] = np.stack([30 + runs, 10 + runs, 20 + runs])
    costs[1, 1, 2] = 10 + runs  # pso and de tie on shifted ackley
    return Comparison(plan, costs)


def test_mean_ranks_and_places() -> None:
    comparison = made_up()
    assert comparison.mean_ranks("plain") == {"gwo": 1.0, "de": 2.0, "pso": 3.0}
    assert comparison.mean_ranks("shifted") == {"gwo": 3.0, "de": 1.25, "pso": 1.75}
    assert comparison.places("shifted") == {"gwo": 3, "de": 1, "pso": 2}
    assert comparison.medians[1, 1].tolist() == [32.5, 12.5, 12.5]


def test_duels_tell_apart_only_what_chance_would_not() -> None:
    comparison = made_up()
    assert comparison.duels("plain", "de")["gwo"] == Duel(better=2, worse=0, undecided=0)
    assert comparison.duels("shifted", "de")["gwo"] == Duel(better=0, worse=2, undecided=0)
    assert comparison.duels("shifted", "de")["pso"] == Duel(better=0, worse=1, undecided=1)
    comparison.costs[0, 0, 0] += 9.0  # 9..14 against 10..15
    assert comparison.duels("plain", "de")["gwo"] == Duel(better=1, worse=0, undecided=1)
    comparison.costs[0, 0] = np.inf
    assert comparison.duels("plain", "de")["gwo"] == Duel(better=1, worse=0, undecided=1)


def test_statement_says_who_falls_and_who_rises() -> None:
    told = statement(made_up())
    assert "On plain functions, by mean rank: gwo (1.00), de (2.00), pso (3.00)." in told
    assert "On shifted functions, by mean rank: de (1.25), pso (1.75), gwo (3.00)." in told
    assert "From plain to shifted functions gwo falls from place 1 to 3. What falls was helped by minima" in told
    assert "against de on 2 shifted functions (Mann-Whitney, Holm, 5 %): gwo 0/2/0, pso 0/1/1." in told


def test_text_and_dict_hold_the_medians(small: Comparison) -> None:
    facts = as_dict(small)
    median = float(np.median(small.of("ackley", "rotated", "cma-es")))
    assert facts["median_cost"]["rotated"]["ackley"]["cma-es"] == median
    assert f"{median:.3g}" in text(small)
    assert facts["mean_rank"]["plain"] == small.mean_ranks("plain")
    assert text(small).endswith(statement(small))


def test_csv_holds_every_run_to_the_last_bit(small: Comparison, tmp_path: Path) -> None:
    path = tmp_path / "all.csv"
    write_report(path, small)
    with open(path, encoding="utf-8", newline="") as file:
        rows = list(csv.DictReader(file))
    assert len(rows) == small.costs.size
    for row in rows:
        costs = small.of(row["function"], row["setting"], row["method"])  # type: ignore[arg-type]
        assert float(row["cost"]) == costs[int(row["run"])]
        assert (row["dimensions"], row["budget"], row["seed"]) == ("3", "60", "7")


@pytest.mark.parametrize("noise", [0.0, 100.0])
def test_every_method_is_named_beside_its_line_and_no_name_is_over_another(noise: float) -> None:
    """Without noise all ranks are apart; the noisier the costs, the closer they are."""
    methods = tuple(METHODS)
    costs = np.arange(len(methods))[:, None] + noise * np.random.default_rng(1).normal(size=(1, 3, len(methods), 40))
    with style():
        comparison = Comparison(Plan(("sphere",), SETTINGS, methods, runs=40), costs)
        figure = plot_ranks({setting: comparison.mean_ranks(setting) for setting in SETTINGS}, "ranks")
        assert faults(figure) == []
        assert [one.get_text() for one in figure.axes[0].texts] == list(methods)
        looks = {(line.get_color(), line.get_linestyle()) for line in figure.axes[0].get_lines()}
        assert len(looks) == len(methods)
        plt.close(figure)


@pytest.mark.parametrize(
    ("change", "things"),
    [
        ({"functions": ("sphere", "cube")}, "no function cube sphere elliptic"),
        ({"methods": ()}, "no method"),
        ({"methods": ("de", "de")}, "method de twice"),
        ({"dimensions": 1}, "dimensions 1 2"),
        ({"budget": 10**12}, "budget 1000000000000 10000000"),
        ({"seed": 1 << 31}, "seed 2147483648 2147483647"),
        ({"methods": ("de",), "pack": 4}, "pack 4 de 5"),
    ],
)
def test_impossible_plans_are_refused_before_anything_runs(change: dict[str, object], things: str) -> None:
    with pytest.raises(UserError) as refused:
        compare(Plan(**change))  # type: ignore[arg-type]
    assert names(refused.value.message, things)
    assert refused.value.exit_code == 2


def test_a_method_of_a_package_that_is_missing_says_how_to_install_it(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setitem(sys.modules, "nevergrad", None)
    with pytest.raises(UserError, match=r"ngopt needs nevergrad; install it: pip install 'greywhale-paper\[peers\]'"):
        Plan(methods=("ngopt",)).check()
