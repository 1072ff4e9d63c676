"""The server's answers to a page: on the board, the arm, the folder, the jobs and the bench of one dashboard."""

from __future__ import annotations

import re
from collections.abc import Mapping
from dataclasses import dataclass
from functools import cached_property
from typing import Any, TypedDict, TypeGuard

from greywhale import __version__
from greywhale.arm.parameters import ArmParameters
from greywhale.base.errors import BadUsage, cut
from greywhale.base.formats import toml_file
from greywhale.base.formats.kinds import Kind, kind_of
from greywhale.board.calibrate import history
from greywhale.board.calibrate.earlier import earlier
from greywhale.dashboard import arm_answers
from greywhale.dashboard.bench import BenchControls
from greywhale.dashboard.folder import FileFacts, Folder
from greywhale.dashboard.jobs import Jobs
from greywhale.dashboard.limits import REQUESTS
from greywhale.dashboard.predict import predict  # here, for a server that imports later lets its board wait
from greywhale.dashboard.relay import Relay
from greywhale.dashboard.samples import samples_of_log
from greywhale.dashboard.torque import PagesTorque, filter_shift_in
from greywhale.files import controller, parameter_file
from greywhale.files.arm import arm_names, load_arm
from greywhale.files.paper_tables import controller_names, controller_path
from greywhale.protocol import schema
from greywhale.protocol.table import ParameterTable

PAGES_REASONS = (history.FOUND, "page", "back", "set")
_TICK = re.compile("[0-9]{1,10}")


class State(TypedDict):
    """The things that a page shows beside the board's own words."""

    greywhale: str  # version
    protocol: int
    schema: str
    port: str  # "" while no board is there
    open: bool
    arm: str
    identified: bool  # it is a model that was identified
    folder: str
    sim: bool
    follows: bool  # a page lets the simulated arm follow when it opens: its board is set up
    files: list[FileFacts]
    controllers: list[str]  # that come with greywhale
    arms: list[str]
    most_upload_bytes: int


class JointFacts(TypedDict):
    min: float  # rad, of the stops
    max: float
    fixed: bool


class ArmFacts(TypedDict):
    name: str
    lengths: list[float]  # m, of the links from the base to the tip
    joints: list[JointFacts]


class ControllerFacts(TypedDict):
    file: str
    source: str
    raw: dict[str, int]  # parameter to raw value; a parameter file has all of them


def _is_whole(value: object) -> TypeGuard[int]:
    """True if it is a whole number such as a board sends; JSON's may have thousands of digits."""
    return type(value) is int and abs(value) < 1 << 32


def _table_of(asked: dict[str, Any]) -> ParameterTable:
    """The whole set that a page names, of a board by its number."""
    raw, board = asked.get("raw"), asked.get("board")
    if not isinstance(raw, list) or len(raw) != len(schema.PARAMETERS) or not all(map(_is_whole, raw)):
        raise BadUsage(f"raw must be {len(schema.PARAMETERS)} whole numbers, a board's parameters.")
    if not _is_whole(board):
        raise BadUsage("board must be a number.")
    return ParameterTable(tuple(raw), schema.Board.of(board))


def arm_facts(arm: ArmParameters) -> ArmFacts:
    joints: list[JointFacts] = [
        {"min": joint.stops.min, "max": joint.stops.max, "fixed": joint.fixed} for joint in arm.joint
    ]
    return {"name": arm.name, "lengths": [link.length for link in arm.link], "joints": joints}


@dataclass
class Answers:
    """Their sources. `arm` is the name of a built-in arm or an arm.toml."""

    relay: Relay
    folder: Folder
    arm: str
    jobs: Jobs
    bench: BenchControls | None = None
    follows: bool = False

    def state(self) -> State:
        link = self.relay.link
        return {
            "greywhale": __version__,
            "protocol": schema.PROTOCOL,
            "schema": f"{schema.SCHEMA_HASH:#010x}",
            "port": link["port"],
            "open": link["open"],
            "arm": self.arm,
            "identified": self._is_identified,
            "folder": str(self.folder.path),
            "sim": self.bench is not None,
            "follows": self.follows,
            "files": self.folder.files(),
            "controllers": controller_names(),
            "arms": arm_names(),
            "most_upload_bytes": REQUESTS.most_upload_bytes,
        }

    def history(self, tick: str | None) -> bytes:
        """The frames of the samples kept, from a tick on if one is given."""
        if tick is not None and not (_TICK.fullmatch(tick) and int(tick) < 1 << 32):
            raise BadUsage(f"from is {cut(tick, 20)}; it must be a tick, 0 to 4294967295.")
        return self.relay.history.since(None if tick is None else int(tick))

    def describe_arm(self, file: str | None) -> ArmFacts:
        return arm_facts(self._arm(file))

    def controller(self, file: str) -> ControllerFacts:
        """The numbers of a controller.toml, or of a parameter file."""
        path = controller_path(file) if file in controller_names() else self.folder.file(file)
        if kind_of(toml_file.read(path)) is Kind.PARAMETERS:
            return {"file": file, "source": "", "raw": parameter_file.load_stated(path)}
        loaded = controller.load(path)
        return {"file": file, "source": loaded.source, "raw": loaded.raw_values()}

    def log(self, file: str) -> bytes:
        """The samples of a log of the folder, as `samples_of_log` says."""
        return samples_of_log(self.folder.file(file))

    def predict(self, asked: dict[str, Any]) -> object:
        table, file = _table_of(asked), asked.get("file")
        if not (file is None or isinstance(file, str)):
            raise BadUsage("file must be the name of an arm or a model.")
        return predict(self._arm(file), table)

    def torque(self, asked: Mapping[str, str]) -> PagesTorque:
        """The torques from outside for a page, by the `file` of a model and the board's `filter_shift`."""
        return PagesTorque(self._arm(asked.get("file")), filter_shift_in(asked))

    def calibrations(self) -> dict[str, Any]:
        """The calibrations that the board at the port has had, as far as they were kept."""
        return {"calibrations": earlier(history.folder_of(self._port()))}

    def keep_calibration(self, asked: dict[str, Any]) -> dict[str, Any]:
        """Keep the calibration of a set that a page read from the board, or gave it."""
        why = asked.get("why")
        if why not in PAGES_REASONS:
            raise BadUsage(f"why must be one of {', '.join(PAGES_REASONS)}.")
        history.try_to_keep(self._port(), _table_of(asked), why)
        return {}

    def _port(self) -> str:
        if not (port := self.relay.link["port"]):
            raise BadUsage(self.relay.link["sentence"] or "no board is there yet.")
        return str(port)

    def change_bench(self, wish: dict[str, Any], page: str) -> dict[str, Any]:
        """Change the bench as a page wishes, and return its controls, as `BenchControls.change` says."""
        if self.bench is None:
            raise BadUsage("no bench belongs to this dashboard; start it with --sim.")
        self.relay.require_bench(page)
        return self.bench.change(wish)

    def file(self, name: str) -> bytes:
        """The content of a file of the folder, for a person to keep."""
        return self.folder.own(name).read_bytes()

    def rename(self, asked: dict[str, Any]) -> dict[str, Any]:
        name, new = asked.get("name"), asked.get("to")
        if not isinstance(name, str) or not isinstance(new, str):
            raise BadUsage("name and to must be names of files.")
        self.folder.rename(name, new)
        return {}

    def remove(self, name: str) -> dict[str, Any]:
        self.folder.remove(name)
        return {}

    def questions(self, asked: dict[str, Any]) -> dict[str, Any]:
        """The questions of `arm new` that follow from the `answers` so far."""
        return {"headings": arm_answers.questions(asked.get("answers"), self.folder)}

    @cached_property
    def _is_identified(self) -> bool:
        return load_arm(self.arm).identification is not None

    def _arm(self, file: str | None) -> ArmParameters:
        if file is None or file == self.arm:
            return load_arm(self.arm)
        return load_arm(file if file in arm_names() else self.folder.file(file))
