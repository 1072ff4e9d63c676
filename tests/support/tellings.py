"""The results of all verbs that a page may start, as they tell them, in no time: what would take long is made up."""

from __future__ import annotations

import re
from collections import Counter
from collections.abc import Iterator
from dataclasses import dataclass, field
from pathlib import Path
from types import SimpleNamespace
from typing import Any

import numpy as np
import pytest

from greywhale import adapt, commission
from greywhale.adapt.decide import Outcome, TriedSet
from greywhale.adapt.result import AdaptationResult
from greywhale.arm.plants import plant_row
from greywhale.base.telling import Telling
from greywhale.cli import countdown, entry, output
from greywhale.cli import flash as flash_verb
from greywhale.cli import identify as identify_verb
from greywhale.cli import tune as tune_verb
from greywhale.commission.judge import TrialVerdict
from greywhale.commission.measures import NAMES, Measures
from greywhale.commission.motions import PARTS
from greywhale.commission.result import CommissioningResult
from greywhale.commission.trials import Trial
from greywhale.files.arm import default_arm
from greywhale.files.leader import save_leader
from greywhale.files.log.layout import Origin
from greywhale.files.trajectory import Trajectory
from greywhale.identify.combinations import Combination
from greywhale.identify.found_model import FoundModel, ParameterEstimate
from greywhale.identify.judge import FIT, LogVerdict
from greywhale.identify.result import IdentificationResult
from greywhale.loop.traces import Traces
from greywhale.protocol import schema
from greywhale.protocol.table import ParameterTable
from tests.adapt.test_decide import stiffer
from tests.arm.make.test_new import ANSWERS
from tests.board.fake_board import FakeBoard
from tests.cli.example_log import write_log
from tests.tune.models import judged, write_model

TABLE = ParameterTable.defaults()
# The marks that a terminal has in the place of lines, bold letters and lists.
MARKS = re.compile(r"[\[\]`→]|->|^- |:$", re.MULTILINE)


def words(text: str) -> Counter[str]:
    """The words of a result, wherever it stands."""
    return Counter(word for word in MARKS.sub("", text).split() if word != "-")


def words_in(telling: Any) -> Counter[str]:
    """The words of a result as data: all texts of its parts, but for what a page makes pictures and buttons of."""
    parts = [part for part in telling["parts"] if part["kind"] != "motions"]
    return words("\n".join(_texts([{**part, "kind": ""} for part in parts])))


def _texts(value: Any) -> Iterator[str]:
    if isinstance(value, str):
        yield value
    elif isinstance(value, dict | list):
        for one in value.values() if isinstance(value, dict) else value:
            yield from _texts(one)


@dataclass
class Page:
    """Stands for a page at which nobody looks."""

    told: list[Telling] = field(default_factory=list)

    def __call__(self, what: str, fraction: float, note: str = "") -> None: ...
    def counts(self, left: int) -> None: ...
    def tells(self, telling: Telling) -> None:
        self.told.append(telling)


@pytest.fixture
def told_by_verbs(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> dict[str, tuple[Telling, str]]:
    """What each verb tells a page, and what it prints meanwhile."""
    page = Page()
    monkeypatch.chdir(tmp_path)
    monkeypatch.setattr(output, "watcher", page)
    monkeypatch.setattr(countdown, "SECOND_S", 0.0)
    monkeypatch.setattr(countdown.warn_page, "__defaults__", (lambda seconds: None,))
    write_log(Path("log.csv"))
    save_leader(Path("motion.csv"), Trajectory(np.array([0.0, 0.5]), np.zeros((2, 4))))
    write_model(Path("model.toml"))
    Path("answers.toml").write_text(ANSWERS, encoding="utf-8")
    made_up(monkeypatch)
    capsys.readouterr()
    found = {}
    with FakeBoard() as board:
        monkeypatch.setattr(flash_verb, "flash", lambda *given: schema.HelloReply.unpack(board.hello()))
        for line in LINES:
            verb = re.split(r" (?=[^ ]*[.=-]|table_8|default)", line)[0]
            needs_board = not line.startswith(("arm new", "evaluate", "identify", "tune"))
            code = entry.run([*line.split(), *(["--port", board.port] if needs_board else [])])
            printed = capsys.readouterr()
            assert len(page.told) == 1, f"{line}: {code} {printed.err}"
            found[verb] = page.told.pop(), printed.out
    return found


LINES = (
    "arm new --answers answers.toml --out arm.toml",
    "arm match default --out matched.toml",
    "record --seconds 0.3 --enable --out record.csv",
    "replay motion.csv --out replay.csv",
    "doctor --seconds 0.5",
    "info",
    "evaluate log.csv record.csv",
    "identify log.csv --out found.toml",
    "tune model.toml --force",
    "commission --model model.toml --out commission",
    "adapt model.toml",
    "params backup kept.toml",
    "upload table_8",
    "params diff kept.toml",
    "params restore kept.toml",
    "flash",
)


def made_up(patch: pytest.MonkeyPatch) -> None:
    """Nothing is searched, and no arm moves for it."""
    patch.setattr(identify_verb, "identify", lambda *given, **options: identified())
    patch.setattr(tune_verb, "tune", lambda *given, **options: judged(Path("model.toml")))
    patch.setattr(commission, "commission", lambda *given: commissioned())
    patch.setattr("greywhale.commission.page.save_page", lambda outcome, path: path)
    patch.setattr(CommissioningResult, "predicted", lambda outcome, trial, round_: trial.measured)
    patch.setattr(CommissioningResult, "round_of", lambda outcome, trial: None)
    patch.setattr(adapt, "adapt", lambda *given: adapted())


def identified() -> IdentificationResult:
    arm = default_arm()
    estimates = (ParameterEstimate("joint0.inertia", "of all that turns", "kg m²", 0.01, 0.012345, 0.00042),)
    pair = Combination("joint1.inertia / joint1.alpha", 0.5, 0.02)
    open_ = ("joint 3 hardly moved",)
    found = FoundModel(
        *(plant_row(arm), np.zeros(4), (0, 1, 2, 3), "motors, friction", estimates, open_, 7, 3.0, True),
        combinations=(pair,),
        condition=2e6,
    )
    verdict = LogVerdict("log.csv", "fit", "closed loop", (4e-3, 3e-3, 2e-3, 1e-3), (4e-5, 3e-5, 2e-5, 1e-5))
    log: Any = SimpleNamespace(role=FIT, table=None, log=SimpleNamespace(log=SimpleNamespace(origin=Origin())))
    return IdentificationResult(arm, "default", 0, found, (verdict,), ("a warning",), (), (log,))


def commissioned() -> CommissioningResult:
    trials = [_trial("before", 0.03, ()), _trial("trial-1", 0.01, ("it hisses",))]
    known = SimpleNamespace(before=trials[0], done=trials, table=TABLE, softened=[])
    return CommissioningResult(known, (), trials[1])  # type: ignore[arg-type] # that is all it asks


def _trial(name: str, rad: float, faults: tuple[str, ...]) -> Trial:
    sizes = np.add.outer(np.arange(len(PARTS)), np.arange(4)) * 1e-3 + rad
    table = TABLE.with_controllers(stiffer(1.0 + rad))
    verdicts = tuple(TrialVerdict(joint, faults, True, True, 1.1, 0.5, 0.25, True, True) for joint in range(4))
    measured = Measures(**dict.fromkeys(NAMES, sizes**2))
    nothing = Traces(np.zeros((1, 4)), np.zeros((1, 4)), np.zeros((1, 4)), 0.0)
    return Trial(name, np.array(table.controllers), table, Path("record.csv"), "", measured, verdicts, nothing)


def adapted() -> AdaptationResult:
    kept = TABLE.with_controllers(stiffer(1.3))
    tried = TriedSet(stiffer(1.3), kept.crc, 3.0, 0.8, Outcome.KEPT, "20 % less error", 1.0, 0.8, 0.7, 0.9)
    return AdaptationResult(TABLE, kept, (tried,), 60.0, 2, 1, 0.0021, {}, "a set was still on trial")
