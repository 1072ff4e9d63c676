"""Writes a joint's controller as a MATLAB .fis file, which MATLAB and GNU Octave read."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from pathlib import Path

from greywhale.base.formats.whole import write_text
from greywhale.fuzzy.rules import OUTPUTS, RULES

# MATLAB and Octave sample the output at 101 points. Equal triangles apart from each other, scaled by the rules' heights
# (product), have their centroid where the peaks that they stand for have it, exactly: each lies evenly about a sample.
OUTPUT_HALF_WIDTH = 0.25
# Within [-1, 1] the same as a foot at the shoulder itself, which Octave's trapmf does not take.
OUTER_FOOT = 1.01
E_SETS = ("NE", "ZE", "PE")
CE_SETS = ("NCE", "ZCE", "PCE")
U_SETS = ("NU", "ZU", "PU")


def _number(value: float) -> str:
    return repr(float(value)).removesuffix(".0")


def _vector(values: Sequence[float]) -> str:
    return "[" + " ".join(_number(value) for value in values) + "]"


def _variable(section: str, name: str, end: float, functions: Sequence[tuple[str, str, Sequence[float]]]) -> list[str]:
    lines = [f"[{section}]", f"Name='{name}'", f"Range={_vector((-end, end))}", f"NumMFs={len(functions)}"]
    for number, (label, kind, corners) in enumerate(functions, start=1):
        lines.append(f"MF{number}='{label}':'{kind}',{_vector(corners)}")
    return [*lines, ""]


def _input(section: str, name: str, labels: Sequence[str], corners: Sequence[float]) -> list[str]:
    n_c, z_a, z_c, p_b = corners
    return _variable(
        section,
        name,
        1.0,
        [
            (labels[0], "trapmf", (-OUTER_FOOT, -1, n_c, 0)),
            (labels[1], "trimf", (z_a, 0, z_c)),
            (labels[2], "trapmf", (0, p_b, 1, OUTER_FOOT)),
        ],
    )


def fis_text(name: str, sets: Mapping[str, float]) -> str:
    """The file's text. `sets` has ne_c, ze_a, ze_c, pe_b, nce_c, zce_a, zce_c, pce_b; the inputs are Kp e and Kd ce."""
    rules = [
        f"{E_SETS.index(e) + 1} {CE_SETS.index(ce) + 1}, {U_SETS.index(u) + 1} (1) : 1"
        for e, row in RULES.items()
        for ce, u in row.items()
    ]
    system = [
        "[System]",
        f"Name='{name}'",
        "Type='mamdani'",
        "Version=2.0",
        "NumInputs=2",
        "NumOutputs=1",
        f"NumRules={len(rules)}",
        "AndMethod='min'",
        "OrMethod='max'",
        "ImpMethod='prod'",
        "AggMethod='max'",
        "DefuzzMethod='centroid'",
        "",
    ]
    peaks = [(label, "trimf", [OUTPUTS[label] + side * OUTPUT_HALF_WIDTH for side in (-1, 0, 1)]) for label in U_SETS]
    lines = [
        *system,
        *_input("Input1", "e", E_SETS, [sets[key] for key in ("ne_c", "ze_a", "ze_c", "pe_b")]),
        *_input("Input2", "ce", CE_SETS, [sets[key] for key in ("nce_c", "zce_a", "zce_c", "pce_b")]),
        *_variable("Output1", "u", 1.0 + OUTPUT_HALF_WIDTH, peaks),
        "[Rules]",
        *rules,
    ]
    return "\n".join(lines) + "\n"


def export_fis(path: str | Path, name: str, sets: Mapping[str, float]) -> None:
    """Write the file whole or not at all."""
    write_text(path, fis_text(name, sets))
