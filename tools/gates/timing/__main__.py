"""Prints the bounds of all images beside the worst that was measured on the simulated boards.

python -m tools.gates.timing            the bounds, and the worst measured (minutes)
python -m tools.gates.timing --commit   takes the bounds of the images as they are into budget.toml
"""

from __future__ import annotations

import sys

from tools.gates.timing import budget, measure
from tools.gates.timing.image import Target, Times, built, times


def _row(what: str, bound: int, measured: int) -> str:
    return f"  {what:24} {bound:7} {measured:9}   {bound / measured - 1:+.0%}"


def _response(found: Times, receiving: bool) -> str:
    cycles = found.response(receiving)
    return "no bound below a tick" if cycles is None else f"{cycles} cycles, {cycles / 16:.0f} us"


def _print(target: Target, found: Times) -> None:
    worst = measure.worst(target)
    print(f"{target.title:26} {'bound':>7} {'measured':>9}   cycles")
    for what, bound in budget.flat(found).items():
        print(_row(what, bound, worst[what]))
    print(f"  tick with its interrupts: {_response(found, False)} when nothing is received,")
    print(f"    {_response(found, True)} when bytes come without a gap; the longest that was found with both")
    print(f"    directions full is {measure.busiest(target)} cycles")


def main(arguments: list[str]) -> int:
    targets = [target for target in built() if target.is_described()]
    bounds = {target.title: times(target) for target in targets}
    if arguments == ["--commit"]:
        budget.BUDGET.write_text(budget.text(bounds))
        return 0
    for target in targets:
        _print(target, bounds[target.title])
    return 0


if __name__ == "__main__":
    sys.exit(main(sys.argv[1:]))
