"""Prints the table of docs/errata.md: what each erratum of the printed equations does.

Everything else is corrected. Three figures show the effect: the energy that a frictionless arm without motors gains or
loses in 5 s, and the change of a motion under the paper's controllers (largest angle, total mean squared error).
"""

from __future__ import annotations

from greywhale.reproduce.work.errata import ARMS, cases, effect


def main() -> None:
    for name, errata in cases().items():
        found = effect(0, list(errata))
        energy = "runs away" if found["energy"] is None else f"{found['energy']:.2g} J"
        cells = [f"{found[arm]['angle']:.2g} rad | {100 * (found[arm]['mse'] - 1):+.2f} %" for arm in ARMS]
        print(f"| {name} | {energy} | {' | '.join(cells)} |", flush=True)


if __name__ == "__main__":
    main()
