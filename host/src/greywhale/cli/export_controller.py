"""`greywhale export` of controllers: as MATLAB's .fis, or as one C++ header."""

from __future__ import annotations

from collections.abc import Mapping
from pathlib import Path
from typing import TYPE_CHECKING, TypedDict

from greywhale.base.formats.whole import refuse_inputs, write_text
from greywhale.files.outputs import require_new
from greywhale.protocol.firmware import JOINTS

if TYPE_CHECKING:
    from greywhale.fuzzy.export_header import Header


class HeaderFacts(TypedDict):
    bound_lsb: float  # no answer is farther from the exact centroid, in 1/16384 of half the output's range
    largest_lsb: float  # the largest difference found
    searched: int  # inputs among which it was found
    least_height: float  # that the strongest rule has at every input
    table_bytes: int  # of flash


def has_joints(source: Path | None) -> bool:
    """True of a controller.toml, which holds a law for each joint; a .fis holds one."""
    return source is not None and not _is_fis(source)


def _is_fis(path: Path) -> bool:
    return path.suffix.lower() == ".fis"


def export_fis(source: Path, out: Path, joint: int | None, overwrite: bool) -> list[Path]:
    from greywhale.fuzzy import export_fis as fis_export
    from greywhale.fuzzy.settings import load_joints

    joints = load_joints(source)
    files = _files_of_joints(source, out, ".fis", joint, overwrite)
    for number, path in files.items():
        sets = {key: float(value) for key, value in joints[number].set_values().items()}
        fis_export.export_fis(path, f"{source.stem}, joint {number}", sets)
    return list(files.values())


def _files_of_joints(source: Path, out: Path, suffix: str, joint: int | None, overwrite: bool) -> dict[int, Path]:
    """The file of each joint that is asked for."""
    stem = out.with_suffix("") if out.suffix == suffix else out
    names = [stem.with_name(f"{stem.name}_joint{number}{suffix}") for number in range(JOINTS)]
    files = dict(enumerate(names)) if joint is None else {joint: out}
    for path in files.values():
        refuse_inputs(path, source)
        require_new(overwrite, path)
    return files


def export_headers(source: Path, out: Path, joint: int | None, overwrite: bool) -> dict[Path, Header]:
    from greywhale.files import fis as fis_file
    from greywhale.fuzzy.export_fis import fis_text
    from greywhale.fuzzy.export_header import make_header
    from greywhale.fuzzy.settings import load_joints
    from greywhale.fuzzy.table_law import from_fis

    if _is_fis(source):
        refuse_inputs(out, source)
        require_new(overwrite, out)
        made = {out: make_header(from_fis(fis_file.load(source), str(source)), source.name, out.name)}
    else:
        joints = load_joints(source)
        made = {}
        for number, path in _files_of_joints(source, out, ".h", joint, overwrite).items():
            sets = {key: float(value) for key, value in joints[number].set_values().items()}
            name = f"{source.stem}, joint {number}"
            law = from_fis(fis_file.parse(fis_text(name, sets)), str(source))
            made[path] = make_header(law, name, path.name, joints[number])
    for path, header in made.items():
        write_text(path, header.text)
    return made


def facts_of(made: Mapping[Path, Header]) -> list[HeaderFacts]:
    """The facts of headers, in their order."""
    return [
        {
            "bound_lsb": header.proof.bound,
            "largest_lsb": header.proof.largest,
            "searched": header.proof.searched,
            "least_height": header.proof.least_height,
            "table_bytes": header.table_bytes,
        }
        for header in made.values()
    ]


def tell_headers(made: Mapping[Path, Header]) -> str:
    """A line for each header: its size, and how far it is from the exact law."""
    return "\n".join(
        f"{path}: {header.table_bytes} bytes of tables; within {header.proof.bound:.2f} LSB of the exact centroid "
        f"(proven), {header.proof.largest:.2f} found; some rule fires with {header.proof.least_height:.3f} or more."
        for path, header in made.items()
    )
