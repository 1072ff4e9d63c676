"""Writes a law as one C++ header: tables, integer arithmetic, a PD+I, test vectors, and how exact it is."""

from __future__ import annotations

import re
from collections.abc import Iterable, Sequence
from dataclasses import dataclass
from importlib.metadata import version
from importlib.resources import files

import numpy as np

from greywhale.base.errors import UserError
from greywhale.fuzzy import table_twin as twin
from greywhale.fuzzy.header_proof import PLACES, Proof, prove
from greywhale.fuzzy.settings import ANGLE_UNIT, GAIN_UNIT, KD_SPAN_MS, JointSettings
from greywhale.fuzzy.table_law import NO_RULE, Axis, TableLaw
from greywhale.fuzzy.table_twin import END, Flank, IntegerLaw, IntegerSet, IntegerShape, Ints

VECTORS = 64
FLASH_OF = {"set": 24, "shape": 22, "vector": 6}  # bytes; vectors are dropped where self_test() is not called
OUTPUT_END = 1.25  # where the range of a controller's output ends: export_fis draws it so
# Words that C++ and Arduino's core have for themselves.
TAKEN = {
    *("auto", "bool", "char", "class", "const", "default", "delete", "double", "enum", "explicit", "extern", "float"),
    *("friend", "inline", "int", "long", "mutable", "namespace", "new", "operator", "private", "protected", "public"),
    *("register", "short", "signed", "static", "std", "struct", "switch", "template", "this", "typedef", "union"),
    *("unsigned", "using", "virtual", "void", "volatile", "while", "main", "min", "max", "abs", "bit", "round"),
}
CLIPPED = """\
// What lies below a height.
inline Sum below(const Shape& shape, uint16_t height) {
  const int32_t moment = take(shape.m2) + scale(take(shape.m3), height);
  return {scale(take(shape.a1) + scale(take(shape.a2), height), height),
          scale(take(shape.m1) + scale(moment, height), height)};
}
"""
SCALED = """\
// A set, scaled by a height.
inline Sum below(const Shape& shape, uint16_t height) {
  return {scale(take(shape.a1), height), scale(take(shape.m1), height)};
}
"""
SUBTRACT = """\
    if (k == 0) continue;
    uint16_t both = heights[k] < heights[k - 1] ? heights[k] : heights[k - 1];
    const uint16_t top = take(shared[k - 1].top);
    if (both > top) both = top;
    if (both == 0) continue;
    const Sum twice = below(shared[k - 1], both);
    sum.area -= twice.area;
    sum.moment -= twice.moment;"""
JOINT = """\
// The controller of {source}: errors in 1/4096 rad, the answer in mV, a period of {period} ms.
inline PdI controller() {{ return {{{kp}, {kd}, {ki}, {ku}, 0, 0, false}}; }}

"""


@dataclass(frozen=True)
class Header:
    """The text, and what was found out about it."""

    text: str
    proof: Proof
    table_bytes: int


def make_header(
    law: TableLaw, source: str, file: str, joint: JointSettings | None = None, period_ms: int = KD_SPAN_MS
) -> Header:
    """The header for a file of this name; UserError where the law has a hole. `joint` adds its gains."""
    numbers = twin.of_law(law)
    proof = prove(law, numbers)
    sets = sum(map(len, numbers.inputs))
    table_bytes = (
        FLASH_OF["set"] * sets + FLASH_OF["shape"] * (len(numbers.own) + len(numbers.shared)) + numbers.table.size
    )
    vectors = _vectors(numbers, proof)
    space = name_of(file)
    output = law.output
    step = float(output.high - output.low) / 2 / END
    words = {
        "TITLE": f"{_plain(law.name) or space}, a fuzzy law",
        "VERSION": version("greywhale"),
        "SOURCE": _plain(source),
        "FILE": _plain(file),
        "NAMESPACE": space,
        "GUARD": f"GREYWHALE_{space.upper()}_H",
        "INPUTS": "\n//   ".join(_range(axis) for axis in law.inputs),
        "OUTPUT": f"{_range(output)}; rules {'clip (min)' if law.clipped else 'scale (prod)'} its sets",
        "BOUND": f"{proof.bound:.2f}",
        "BOUND_REAL": f"{proof.bound * step:.2g}",
        "UNIT": f"of {_plain(output.name)}",
        "LARGEST": f"{proof.largest:.2f}",
        "AT": f"{proof.at[0]}, {proof.at[1]}",
        "SEARCHED": f"{proof.searched:,}",
        "LEAST": f"{np.floor(proof.least_height * 1000) / 1000:.3f}",
        "BYTES": str(table_bytes),
        "VECTORS": str(len(vectors)),
        "SETS_E": str(len(numbers.inputs[0])),
        "SETS_CE": str(len(numbers.inputs[1])),
        "SETS_U": str(len(numbers.own)),
        "E_SETS": _sets(numbers.inputs[0], law.inputs[0].names),
        "CE_SETS": _sets(numbers.inputs[1], law.inputs[1].names),
        "RULES": _rows([255 if one == NO_RULE else one for one in row] for row in law.table),
        "SHAPES": _shapes(numbers.own),
        "SHARED": _shared(numbers.shared, space),
        "BELOW": CLIPPED if law.clipped else SCALED,
        "SUBTRACT": SUBTRACT if numbers.shared else "",
        "JOINT": "" if joint is None else _joint(joint, source, period_ms),
        "VECTOR_ROWS": _rows(vectors),
    }
    template = files("greywhale.fuzzy").joinpath("law.h.in").read_text(encoding="utf-8")
    text = re.sub(r"@([A-Z_]+)@", lambda match: words[match[1]], template)
    return Header(re.sub(r"\n{3,}", "\n\n", text), proof, table_bytes)


def name_of(file: str) -> str:
    """The namespace of a header of this name."""
    name = re.sub(r"\W+", "_", file.rsplit("/", 1)[-1].removesuffix(".h"), flags=re.ASCII).strip("_").lower()
    return f"law_{name}".rstrip("_") if not name or name[0].isdigit() or name in TAKEN else name


def _plain(text: str) -> str:
    """Text for one line of comment, whatever a file calls itself: nothing that would join it with the next line."""
    return re.sub(r"[^\x20-\x3e\x40-\x5b\x5d-\x7e]", "_", text)[:80]


def _range(axis: Axis) -> str:
    return f"{_plain(axis.name)}, {float(axis.low):g} to {float(axis.high):g}: {_plain(' '.join(axis.names))}"


def _rows(rows: Iterable[Iterable[int]]) -> str:
    return "\n".join("    {" + ", ".join(map(str, row)) + "}," for row in rows)


def _sets(sets: Sequence[IntegerSet], names: Sequence[str]) -> str:
    rows = (
        f"    {{{_flank(one.rise)}, {_flank(one.fall)}}},  // {_plain(name)}"
        for one, name in zip(sets, names, strict=True)
    )
    return "\n".join(rows)


def _flank(flank: Flank) -> str:
    return f"{{{flank.base}, {flank.full}, {flank.slope}u, {flank.offset & 0xFFFFFFFF}u}}"


def _shapes(shapes: Sequence[IntegerShape]) -> str:
    return _rows((*shape.area, *shape.moment, shape.top) for shape in shapes)


def _shared(shapes: Sequence[IntegerShape], space: str) -> str:
    if not shapes:
        return ""
    flash = f"GREYWHALE_{space.upper()}_H_FLASH"
    return (
        "// What each set shares with the next one.\n"
        f"static const Shape shared[sets_u - 1] {flash} = {{\n{_shapes(shapes)}\n}};\n"
    )


def _vectors(numbers: IntegerLaw, proof: Proof) -> list[tuple[int, int, int]]:
    """The ends, the middle, the place of the largest difference, where edges meet, and places between."""
    random = np.random.default_rng(1)
    bends = [
        np.array([place for one in sets for place in (one.rise.full, one.fall.full) if abs(place) <= END] or [0])
        for sets in numbers.inputs
    ]
    fixed = [(e, ce) for e in (-END, 0, END) for ce in (-END, 0, END)] + [proof.at]
    fixed += [(int(random.choice(bends[0])), int(random.choice(bends[1]))) for _ in range(VECTORS // 4)]
    free = random.choice(PLACES, (VECTORS - len(fixed), 2))
    e, ce = np.concatenate([np.array(fixed), free]).T
    answers: Ints = twin.u(numbers, e, ce)
    return [(int(a), int(b), int(c)) for a, b, c in zip(e, ce, answers, strict=True)]


def _joint(joint: JointSettings, source: str, period_ms: int) -> str:
    if joint.ce_ticks != 1:
        raise UserError(
            f"{source}: ce_ticks is {joint.ce_ticks}: a header takes the change of error over one period;"
            " write ce_ticks = 1."
        )
    step = END / ANGLE_UNIT
    gains = {
        "kp": round(joint.kp * step),
        "kd": round(joint.kd * step * KD_SPAN_MS / period_ms),
        "ki": round(joint.ki / GAIN_UNIT * period_ms / ANGLE_UNIT * 2**32),
        "ku": round(joint.ku_mv * OUTPUT_END),
    }
    return JOINT.format(source=_plain(source), period=period_ms, **gains)
