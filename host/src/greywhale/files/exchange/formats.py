"""The formats of other programs in which a log can be written."""

from __future__ import annotations

import importlib
import pkgutil
from collections.abc import Iterable
from dataclasses import asdict, dataclass
from pathlib import Path
from typing import Any, Protocol

from greywhale.base.errors import BadUsage
from greywhale.files.exchange.recording import ExportOptions, Recording


class Writer(Protocol):
    """Writes recordings to `out`, whole or not at all, and returns the paths written. UserError: what cannot be
    written, and why.
    """

    def __call__(self, recordings: Iterable[Recording], out: Path, options: ExportOptions) -> list[Path]: ...


@dataclass(frozen=True)
class Format:
    does: str  # a sentence for --help
    writer: str  # module:function below this package, imported when it is needed
    extra: str = ""  # the extra of greywhale that it needs
    packages: tuple[str, ...] = ()  # the modules that this extra brings
    options: tuple[str, ...] = ()  # fields of ExportOptions that it takes
    many: bool = False  # whether it takes more than one log
    folder: tuple[str, ...] = ()  # what it writes is a folder, which holds these


TORQUE = ("model",)  # which computes quantities beside those of the log
FORMATS = {
    "bam": Format("one joint for Rhoban's BAM.", "bam:write", options=("joint", "mass", "length")),
    "mcap": Format("for PlotJuggler and Foxglove.", "mcap:write", "mcap", ("mcap.writer", "google.protobuf"), TORQUE),
    "mat": Format("for MATLAB and Octave.", "mat:write", options=TORQUE),
    "lerobot": Format(
        "a LeRobot dataset v3.0 (a folder), one log an episode.",
        "lerobot:write",
        extra="lerobot",
        packages=("pyarrow.parquet",),
        options=("fps", "task", *TORQUE),
        many=True,
        folder=("data", "meta"),
    ),
    "npz": Format("numpy's arrays.", "npz:write", options=TORQUE),
    "parquet": Format("a table for pandas, DuckDB and others.", "parquet:write", "parquet", ("pyarrow",), TORQUE),
}


def write(name: str, recordings: Iterable[Recording], out: Path, options: ExportOptions) -> list[Path]:
    """Write recordings in the format `name`; the paths written."""
    writer: Writer = pkgutil.resolve_name(f"{__package__}.{FORMATS[name].writer}")
    return writer(recordings, out, options)


def require_possible(name: str, logs: int, options: ExportOptions) -> None:
    """Refuse what the format `name` does not take, and a greywhale without the packages that it needs, as bad usage."""
    wanted = FORMATS[name]
    if logs > 1 and not wanted.many:
        raise BadUsage(f"--to {name} takes one log, and {logs} were given; call it once for each.")
    for option, value in asdict(options).items():
        if value is not None and option not in wanted.options:
            raise BadUsage(f"--{option.replace('_', '-')} does not go with --to {name}; leave it out.")
    require_packages(f"--to {name}", wanted.extra, *wanted.packages)


def require_packages(what: str, extra: str, *packages: str) -> None:
    """Refuse where a module cannot be imported that the extra brings, in a sentence that begins with `what`."""
    for package in packages:
        import_extra(what, extra, package)


def import_extra(what: str, extra: str, package: str) -> Any:
    """A module that one of greywhale's extras brings."""
    try:
        return importlib.import_module(package)
    except ImportError:
        raise BadUsage(f"{what} needs the package {package}; install it: pip install 'greywhale[{extra}]'.") from None
