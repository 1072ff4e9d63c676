"""Files of other programs, opened for their columns: their names, their numbers, and what is known of them."""

from __future__ import annotations

import json
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from greywhale.base.errors import BadUsage, UserError, cut, os_reason
from greywhale.base.formats import csv_dialect
from greywhale.base.formats.whole import refuse_devices
from greywhale.base.types import Floats
from greywhale.files.exchange import bam, mat
from greywhale.files.exchange.columns import STATE, TIME, Rule
from greywhale.files.exchange.formats import import_extra
from greywhale.protocol.firmware import JOINTS

Columns = dict[str, NDArray[Any]]


@dataclass(frozen=True)
class Source:
    """A file's columns by name: `load` takes those wanted as numbers and those wanted as words. `facts` are those of a
    log that greywhale exported, `usual` the rules that the format itself gives.
    """

    names: tuple[str, ...]
    load: Callable[[Sequence[str], Sequence[str]], Columns]
    facts: Mapping[str, str] = field(default_factory=dict)
    usual: Mapping[str, Rule] = field(default_factory=dict)


def open_source(path: Path, format_: str, joint: int | None) -> Source:
    """Open a file in one of the formats of READERS; `joint` is where a recording of one joint goes.

    UserError: what cannot be read, and why.
    """
    if joint is not None and format_ != "bam":
        raise BadUsage("--joint goes with --from bam; other files name the joints' columns.")
    try:
        refuse_devices(path)
        return READERS[format_](path, joint)
    except OSError as error:
        raise UserError(f"{path}: cannot be read: {os_reason(error)}.") from None
    except UserError:
        raise
    except Exception as error:  # whatever the formats' own readers say
        raise UserError(f"{path}: cannot be read as {format_}: {_first_sentence(error)}.") from None


def _first_sentence(error: Exception) -> str:
    """A reader's own words; numpy goes on with advice to trust the file."""
    told = str(error) or type(error).__name__
    return cut(told.splitlines()[0].split(". ")[0].rstrip("."), 200)


def _held(columns: Columns, facts: Mapping[str, str], usual: Mapping[str, Rule]) -> Source:
    """A source whose columns are in memory."""
    return Source(
        tuple(columns), lambda numbers, words: {one: columns[one] for one in (*numbers, *words)}, facts, usual
    )


def _read_bam(path: Path, joint: int | None) -> Source:
    data = json.loads(path.read_text(encoding="utf-8"))
    entries = data["entries"]
    keys = [key for key in entries[0] if all(isinstance(entry.get(key), int | float) for entry in entries)]
    columns: Columns = {key: np.array([entry[key] for entry in entries], dtype=np.float64) for key in keys}
    if {"load", "input_volts"} <= columns.keys():
        load = _signed(columns["load"])
        columns["volts"] = load / bam.full_load(data.get("motor"), load) * columns["input_volts"]
    if "torque_enable" in columns:
        columns["powered"] = np.where(columns["torque_enable"] > 0.0, "following", "disabled")
    place = joint if joint is not None else int(data.get(bam.JOINT, 0))
    sources = {TIME: "timestamp", "leader": "goal_position", "follower": "position", "voltage": "volts"}
    usual = {name if name == TIME else f"{name}_{place}": Rule(source) for name, source in sources.items()}
    usual[TIME] = Rule("timestamp", offset=float(data.get(bam.START, 0.0)))
    return _held(columns, {}, usual | {STATE: Rule("powered")})


def _signed(load: Floats) -> Floats:
    """Loads with their sign: recordings of XL330 motors hold negative ones as 16 bits without a sign. What BAM made of
    these by interpolation cannot be mended.
    """
    wrapped = load >= 1 << 15
    return np.where(wrapped, load - (1 << 16), load) if wrapped.any() and (load % 1.0 == 0.0).all() else load


def _read_csv(path: Path, joint: int | None) -> Source:
    with open(path, encoding="utf-8-sig") as file:
        before = 1
        while csv_dialect.comment_in(heading := file.readline()) is not None or heading.isspace():
            before += 1
    separator = max(csv_dialect.SEPARATORS, key=heading.count)
    names = tuple(csv_dialect.cells_of(heading.rstrip("\r\n"), separator))
    if len(set(names)) < len(names) or not all(names):
        raise ValueError(f"its columns need names, each another one, and are {cut(', '.join(names))}")

    def load(numbers: Sequence[str], words: Sequence[str]) -> Columns:
        wanted = [*numbers, *words]
        form = np.dtype([*((one, "f8") for one in numbers), *((one, "U16") for one in words)])
        places = [names.index(one) for one in wanted]
        table = np.loadtxt(path, form, "#", separator, None, before, places, ndmin=1, encoding="utf-8", quotechar='"')
        return {one: table[one] for one in wanted}

    return Source(names, load)


def _read_npz(path: Path, joint: int | None) -> Source:
    held = np.load(path, allow_pickle=False)
    columns = _split({name: held[name] for name in held.files})
    if {"state", "states"} <= columns.keys():
        columns[STATE] = np.asarray(columns.pop("states"))[columns[STATE]]
    return _held(columns, _facts(str(held["facts"])) if "facts" in held.files else {}, {})


def _read_mat(path: Path, joint: int | None) -> Source:
    from scipy import io

    try:
        held = io.loadmat(path)
    except NotImplementedError:
        raise ValueError("it is of version 7.3; save it with `save -v7`") from None
    arrays = {name: value for name, value in held.items() if not name.startswith("__")}
    facts, states = (arrays.pop(name, np.array([])).ravel() for name in ("facts", "states"))
    columns = _split(arrays)
    if STATE in columns and states.size:
        words = np.array([str(word.item()) for word in states])
        columns[STATE] = words[columns[STATE].astype(np.intp) - 1]
    usual = {f"{ours}_{one}": Rule(f"{theirs}_{one}") for ours, theirs in mat.NAMES.items() for one in range(JOINTS)}
    usual |= {f"{ours}_0": Rule(theirs) for ours, theirs in mat.NAMES.items() if theirs in columns}
    return _held(columns, _facts(str(facts[0])) if facts.size else {}, usual | {TIME: Rule("t")})


def _facts(text: str) -> dict[str, str]:
    return {str(key): str(value) for key, value in json.loads(text).items()}


def _split(arrays: Mapping[str, NDArray[Any]]) -> Columns:
    """Arrays of numbers as columns: those of a matrix get the names NAME_0, NAME_1 and so on."""
    columns: Columns = {}
    for name, values in arrays.items():
        if values.ndim == 2 and 1 not in values.shape:
            columns |= dict(zip((f"{name}_{place}" for place in range(values.shape[1])), values.T, strict=True))
        elif values.size > 1:
            columns[name] = values.ravel()
    return columns


def _read_parquet(path: Path, joint: int | None) -> Source:
    parquet = import_extra("--from parquet", "parquet", "pyarrow.parquet")
    schema = parquet.read_schema(path)
    facts = {key.decode(): value.decode() for key, value in (schema.metadata or {}).items()}

    def load(numbers: Sequence[str], words: Sequence[str]) -> Columns:
        table = parquet.read_table(path, columns=[*numbers, *words])
        return {one: table[one].to_numpy() for one in numbers} | {
            one: table[one].cast("string").to_numpy() for one in words
        }

    return Source(tuple(schema.names), load, facts if "recording" in facts else {})


READERS: dict[str, Callable[[Path, int | None], Source]] = {
    "bam": _read_bam,
    "csv": _read_csv,
    "mat": _read_mat,
    "npz": _read_npz,
    "parquet": _read_parquet,
}
