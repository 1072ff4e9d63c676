""".fis files as others write them: tables of any size, and each of what the wild has beside them."""

from __future__ import annotations

from collections.abc import Callable

RANGES = {"Input1": ("error", -3.0, 3.0), "Input2": ("change", -10.0, 10.0), "Output1": ("out", -255.0, 255.0)}


def table(size: int) -> str:
    """A table of so many sets a variable, with triangles that cross at 1/2, as a textbook has it."""
    rules = [
        f"{i + 1} {j + 1}, {min(max(i + j - size // 2, 0), size - 1) + 1} (1) : 1"
        for i in range(size)
        for j in range(size)
    ]
    head = [
        *("[System]", f"Name='table{size}'", "Type='mamdani'", "Version=2.0", "NumInputs=2", "NumOutputs=1"),
        *(f"NumRules={len(rules)}", "AndMethod='min'", "OrMethod='max'", "ImpMethod='min'", "AggMethod='max'"),
        *("DefuzzMethod='centroid'", ""),
    ]
    body = [line for section in RANGES for line in variable(section, size)]
    return "\n".join([*head, *body, "[Rules]", *rules]) + "\n"


def variable(section: str, size: int) -> list[str]:
    """A section with even triangles."""
    name, low, high = RANGES[section]
    step = (high - low) / (size - 1)
    lines = [f"[{section}]", f"Name='{name}'", f"Range=[{low:g} {high:g}]", f"NumMFs={size}"]
    for k in range(size):
        left, peak, right = (low + step * place for place in (k - 1, k, k + 1))
        lines.append(f"MF{k + 1}='S{k}':'trimf',[{left:.12g} {peak:.12g} {right:.12g}]")
    return [*lines, ""]


def uneven() -> str:
    """Trapezoids, sets of unequal widths, an output that leans: nothing in it is its own mirror image."""
    text = table(3)
    for old, new in (
        ("MF1='S0':'trimf',[-6 -3 0]", "MF1='S0':'trapmf',[-5 -4 -2 0.31]"),
        ("MF2='S1':'trimf',[-3 0 3]", "MF2='S1':'trapmf',[-1.3 -0.4 0.2 1.7]"),
        ("MF3='S2':'trimf',[0 3 6]", "MF3='S2':'trapmf',[0.1 2.2 3 3]"),
        ("MF2='S1':'trimf',[-255 0 255]", "MF2='S1':'trapmf',[-200 -31 12 190]"),
        ("MF3='S2':'trimf',[0 255 510]", "MF3='S2':'trimf',[33 201 255]"),
    ):
        assert old in text
        text = text.replace(old, new)
    return text


def _swap(old: str, new: str) -> Callable[[str], str]:
    def change(text: str) -> str:
        assert old in text, old
        return text.replace(old, new, 1)

    return change


def _two_outputs(text: str) -> str:
    second = "\n".join(variable("Output1", 3)).replace("[Output1]", "[Output2]")
    text = text.replace("[Rules]", f"{second}\n[Rules]").replace("NumOutputs=1", "NumOutputs=2")
    return "\n".join(line.replace(" (1)", " 1 (1)") for line in text.split("\n"))


def _one_input(text: str) -> str:
    begin, end = text.index("[Input2]"), text.index("[Output1]")
    lines = (text[:begin] + text[end:]).replace("NumInputs=2", "NumInputs=1").split("\n")
    at = lines.index("[Rules]")
    return "\n".join([*lines[: at + 1], "1, 1 (1) : 1", "2, 2 (1) : 1", "3, 3 (1) : 1", ""])


# Each changes a table of 3 x 3, and the words that say why no header is made of it.
WILD: dict[str, tuple[Callable[[str], str], str]] = {
    "two outputs": (_two_outputs, "2 outputs; a table has 1 output"),
    "one input": (_one_input, "1 inputs; a table has 2 inputs"),
    "sugeno": (_swap("'mamdani'", "'sugeno'"), "line 3: its type is 'sugeno'"),
    "weight": (_swap("1 1, 1 (1)", "1 1, 1 (0.5)"), "line 39: the rule's weight is 0.5"),
    "not": (_swap("1 1, 1 (1)", "-1 1, 1 (1)"), "line 39: the rule says `not`"),
    "left out": (_swap("1 1, 1 (1)", "0 1, 1 (1)"), "line 39: the rule leaves a variable out"),
    "or": (_swap("1 1, 1 (1) : 1", "1 1, 1 (1) : 2"), "line 39: the rule says `or`"),
    "hedge": (_swap("1 1, 1 (1)", "1.05 1, 1 (1)"), "line 39: the rule has a hedge"),
    "gaussian": (_swap("'trimf',[-6 -3 0]", "'gaussmf',[1.2 -3]"), "line 18: 'S0' is a gaussmf"),
    "and by product": (_swap("AndMethod='min'", "AndMethod='prod'"), "line 8: andmethod is 'prod'"),
    "sum": (_swap("AggMethod='max'", "AggMethod='sum'"), "line 11: aggmethod is 'sum'"),
    "bisector": (_swap("'centroid'", "'bisector'"), "line 12: defuzzmethod is 'bisector'"),
    "prod with overlap": (_swap("ImpMethod='min'", "ImpMethod='prod'"), "'S0' and 'S1' overlap"),
    "a second rule": (_swap("1 2, 1 (1)", "1 1, 3 (1)"), "line 40: a second rule for S0 and S0"),
    "backwards": (_swap("[-6 -3 0]", "[0 -3 -6]"), "line 18: 'S0' needs 3 corners"),
    "outside": (_swap("[-6 -3 0]", "[-9 -8 -7]"), "line 18: 'S0' lies outside the range of 'error'"),
    "a hole in the rules": (_swap("1 3, 2 (1) : 1\n", ""), "a hole: at error = -3 and change = "),
}
