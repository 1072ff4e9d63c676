"""kill -9 of every verb that writes a file or moves the arm, at moments that meet every state between its changes."""

from __future__ import annotations

import hashlib
import importlib
import json
import os
import random
import shutil
import tempfile
import tomllib
from collections import Counter
from collections.abc import Iterator
from contextlib import ExitStack, contextmanager
from dataclasses import replace
from functools import partial
from pathlib import Path

import numpy as np

from greywhale import tune as tuning
from greywhale.board.device import Device
from greywhale.board.upload import read_parameters
from greywhale.calibrate.guide import Result
from greywhale.calibrate.solve import Calibration
from greywhale.cli import calibrate, tune
from greywhale.demo import BenchProcess
from greywhale.errors import UserError
from greywhale.files.leader import load_leader
from greywhale.files.log import read_log
from greywhale.files.log.check import Check
from tools.campaign.kill_boards import Bench, Board, Fake, NoBoard
from tools.campaign.kill_verbs import VERBS, Verb, make_inputs
from tools.campaign.killing import NEVER, Ending, Held, Moment, run, wait_for_programs
from tools.campaign.part import Part, Piece, Row, split

OLD = b"what stood here before\n"


# --- a trial ----------------------------------------------------------------------------------------------------------


class Stand:
    """A verb with its inputs in a place of its own, and what a run without a kill gives. A context."""

    def __init__(self, verb: Verb) -> None:
        self.verb = verb
        self._number = 0
        self._met: set[bytes] = set()
        self._sets: list[object] = []
        self.whole: dict[str, bytes] = {}
        self._second: dict[str, bytes] = {}  # what a second run writes on the board that the first has changed

    def __enter__(self) -> Stand:
        # The least possible errors take seconds, and no file is written meanwhile.
        setattr(tune, "tune", partial(tuning.tune, floors=False))  # noqa: B010
        # Nobody turns the joints; what was found is always the same, and is stored as ever.
        setattr(calibrate, "calibrate", _calibrate)  # noqa: B010
        for module in (f"greywhale.cli.{self.verb.arguments.split()[0]}", *self.verb.needs):
            importlib.import_module(module)
        with ExitStack() as stack:
            self.place = Path(stack.enter_context(tempfile.TemporaryDirectory(prefix="gw", ignore_cleanup_errors=True)))
            (self.place / "run").mkdir(0o700)
            before = os.environ.get("XDG_RUNTIME_DIR")
            os.environ["XDG_RUNTIME_DIR"] = str(self.place / "run")
            stack.callback(_restore_environment, before)
            (self.place / "in").mkdir()
            make_inputs(self.verb, self.place / "in")
            self._bench = stack.enter_context(BenchProcess("--speed", "max")) if self.verb.board == "bench" else None
            self._held = None if self.verb.held is None else self._hold(stack, self.verb.held)
            self._learn()
            self._stack = stack.pop_all()
        return self

    def __exit__(self, *error: object) -> None:
        self._stack.close()

    @contextmanager
    def board(self) -> Iterator[Board]:
        with ExitStack() as stack:
            if self.verb.board == "fake":
                yield Fake(stack, self._sets)
            else:
                yield NoBoard() if self._bench is None else Bench(self._bench, self._sets)

    def folder(self) -> Path:
        self._number += 1
        folder = self.place / f"t{self._number}"
        folder.mkdir()
        return folder

    def run(self, folder: Path, board: Board, moment: Moment = NEVER, again: bool = False) -> Ending:
        """Run the verb. A second run is one from its beginning, and goes on from a journal."""
        if self._held is not None and not again:
            return self._held.run(folder, moment)
        arguments = self._arguments(board.port)
        if again and self.verb.journal and (folder / self.verb.journal).exists():
            arguments.append("--resume")
        return run(arguments, folder, moment, board.quick)

    def is_new(self, state: bytes) -> bool:
        """Whether no trial met this state before."""
        new = state not in self._met
        self._met.add(state)
        return new

    @property
    def promised(self) -> list[str]:
        """The files that every run must leave."""
        return [name for name in (*self.verb.logs, *self.whole) if not self.verb.may_write(name)]

    def problem_of(self, name: str, path: Path) -> str:
        """What is wrong with a file that bears the name of a result, "" for nothing."""
        if name in self.verb.logs:
            return _problem_of_log(path, self.verb.logs[name], finished=True)
        if self.verb.vary:
            return _problem_of_kind(path)
        known = self.whole[name], self._second.get(name)
        return "" if path.read_bytes() in known else "is not what an unkilled run writes"

    def _arguments(self, port: str) -> list[str]:
        arguments = self.verb.arguments.format(port=port, **{"in": self.place / "in"}).split()
        return [*arguments, "--overwrite"] if self.verb.logs or self.verb.files else arguments

    def _hold(self, stack: ExitStack, done: int) -> Held:
        return stack.enter_context(Held(self._arguments(""), self.folder(), done))

    def _learn(self) -> None:
        """Run without a kill: the files that the verb writes, how long it takes, how many changes it makes."""
        folder = self.folder()
        with self.board() as board:
            sets = [board.stored]
            self.ending = self._run_whole(folder, board)
            # What commissioning finds depends on how the arm moved.
            self._sets = [] if self.verb.vary else [*sets, board.stored]
            if self.verb.refuses:
                second = self.folder()
                self._run_whole(second, board)
                self._second = {name: path.read_bytes() for name, path in _files(second).items()}
        written = _files(folder)
        self.whole = {name: path.read_bytes() for name, path in written.items() if name not in self.verb.logs}
        wanted = {*self.verb.logs, *(self.whole if self.verb.vary else self.verb.files)}
        for name in wanted ^ set(written):
            raise RuntimeError(f"{self.verb.name} wrote {name} unasked, or did not write it")
        for name, path in written.items():
            if self.problem_of(name, path):
                raise RuntimeError(f"{self.verb.name}: {name} {self.problem_of(name, path)}")
        if not (self.verb.journal or self.verb.refuses) and self.verb.trials >= 100:
            with self.board() as board:  # over files that are there; it is also quicker than the first
                over = self._run_whole(folder, board)
            self.ending = replace(over, changes=max(over.changes, self.ending.changes))

    def _run_whole(self, folder: Path, board: Board) -> Ending:
        ending = self.run(folder, board)
        if ending.code != 0:
            raise RuntimeError(f"{self.verb.name} cannot be tried: {ending.said}")
        return ending


def _calibrate(device: Device, *asked: object) -> Result:
    """A calibration that takes no person and no arm."""
    limits = np.tile([-1.5, 1.5], (4, 1))
    return Result(Calibration(np.full(8, 500.0), np.full(8, 0.005), limits), read_parameters(device), np.zeros(4))


def _restore_environment(before: str | None) -> None:
    if before is None:
        del os.environ["XDG_RUNTIME_DIR"]
    else:
        os.environ["XDG_RUNTIME_DIR"] = before


def _problem_of_log(path: Path, rows: int, finished: bool) -> str:
    try:
        log = read_log(path)
    except UserError as error:
        return f"cannot be read: {error.message}"
    if log.condition.check not in ((Check.WHOLE,) if finished else (Check.WHOLE, Check.UNCHECKED)):
        return f"has a check that says {log.condition.check.value}"
    if finished and not (log.complete and rows in (0, len(log.time))):
        return f"has {len(log.time)} rows, complete: {log.complete}"
    steps = np.diff(log.time)
    if not np.allclose(steps, steps[0], atol=1e-9) and not log.dropped:
        return "has a gap that nobody counted"
    return ""


def _problem_of_kind(path: Path) -> str:
    """What is wrong with a file of which only the kind is known."""
    data = path.read_bytes()
    if path.suffix == ".png":
        return "" if data.startswith(b"\x89PNG") and data.endswith(b"IEND\xaeB`\x82") else "is no whole picture"
    try:
        if path.suffix == ".csv":
            (read_log if data.startswith(b"#") else load_leader)(path)
        elif path.suffix == ".json":
            json.loads(data)
        elif path.suffix == ".toml":
            tomllib.loads(data.decode())
        elif not data.rstrip().endswith(b"</html>"):
            return "is no whole page"
    except (UserError, ValueError) as error:
        return f"cannot be read: {error}"
    return ""


def _files(folder: Path) -> dict[str, Path]:
    """All files below a folder by their paths in it."""
    return {str(path.relative_to(folder)): path for path in sorted(folder.rglob("*")) if path.is_file()}


def try_once(stand: Stand, moment: Moment, old: bool) -> tuple[list[str], list[str]]:
    """Kill the verb at a moment, look at what is left, and run it again: what is wrong, and what was seen."""
    folder, verb = stand.folder(), stand.verb
    promised = stand.promised
    for name in promised if old and not (verb.journal or verb.refuses) else []:
        (folder / name).parent.mkdir(parents=True, exist_ok=True)
        (folder / name).write_bytes(OLD)
    with stand.board() as board:
        ending = stand.run(folder, board, moment)
        wrong = board.settle() + [f"{one} goes on for ever" for one in wait_for_programs(folder)]
        if ending.code not in (None, 0):
            wrong.append(f"ended with {ending.code}: {ending.said}")
        seen = ["had ended before"] if ending.code == 0 else []
        more_wrong, more_seen, hidden = look(stand, folder)
        wrong += more_wrong
        seen += more_seen
        if hidden:
            seen.append("hidden until the next run")
        if stand.is_new(_state(folder, verb) + repr(board.stored).encode()):
            board.restart()
            for name in promised if verb.refuses else []:
                (folder / name).unlink(missing_ok=True)
            again = stand.run(folder, board, again=True)
            if again.code != 0:
                wrong.append(f"the next run ended with {again.code}: {again.said}")
            wrong += board.settle()
            after, _, hidden = look(stand, folder)
            wrong += [f"after the next run: {one}" for one in after]
            wrong += [f"{name} stays" for name in hidden]
            missing = [name for name in promised if not (folder / name).exists() or _is_old(folder / name)]
            wrong += [f"the next run wrote no {name}" for name in missing]
    shutil.rmtree(folder)
    return wrong, seen


def look(stand: Stand, folder: Path) -> tuple[list[str], list[str], list[str]]:
    """What is wrong in a folder, what was seen there, and the hidden files in it."""
    wrong, seen, hidden = [], [], []
    verb = stand.verb
    for name, path in _files(folder).items():
        if path.name.startswith("."):
            hidden.append(name)
        elif name == verb.journal:
            seen.append("journal kept")
        elif name in verb.logs or name in stand.whole or verb.may_write(name):
            if _is_old(path):
                continue
            problem = stand.problem_of(name, path)
            wrong += [f"{name} {problem}"] if problem else []
            seen.append("result whole")
        elif ".unfinished" in name and (verb.logs or verb.vary):
            problem = _problem_of_log(path, 0, finished=False)
            wrong += [f"{name} {problem}"] if problem else []
            seen.append("log kept as unfinished")
        else:
            wrong.append(f"{name} was left behind")
    return wrong, seen, hidden


def _is_old(path: Path) -> bool:
    return path.read_bytes() == OLD


def _state(folder: Path, verb: Verb) -> bytes:
    """What a folder holds. The random part of a hidden name and the samples of a log do not count."""
    digest = hashlib.sha256()
    for name, path in _files(folder).items():
        varies = verb.vary or name in verb.logs or ".unfinished" in name
        content = b"varies" if varies and not _is_old(path) else path.read_bytes()
        digest.update((path.suffix if path.name.startswith(".") else name).encode() + b"\0" + content)
    return digest.digest()


# --- the part ---------------------------------------------------------------------------------------------------------


def moments(stand: Stand, piece: Piece) -> Iterator[Moment]:
    """Half of them at a random time of the run; half at the changes, each in its turn, so that all are met."""
    random_ = random.Random(f"{piece['verb']} {piece['seed']}")
    changes = random_.sample(range(stand.ending.changes), stand.ending.changes)
    for number in range(piece["trials"]):
        if number % 2 or not changes:
            yield Moment(after_s=random_.uniform(0.0, stand.ending.seconds))
        else:
            yield Moment(change=changes[number // 2 % len(changes)], share=random_.choice((0.0, random_.random(), 1.0)))


def do_piece(piece: Piece) -> list[Row]:
    verb = next(verb for verb in VERBS if verb.name == piece["verb"])
    counts: Counter[str] = Counter()
    violations = 0
    with Stand(verb) as stand:
        for number, moment in enumerate(moments(stand, piece)):
            wrong, seen = try_once(stand, moment, old=number % 4 < 2)
            violations += bool(wrong)
            counts.update(seen)
            for one in wrong:
                print(f"{verb.name}, {moment}: {one}", flush=True)
    return [Row(f"`{verb.name}`", piece["trials"], violations, dict(sorted(counts.items())))]


def pieces(share: float) -> list[Piece]:
    return [piece for verb in VERBS for piece in split(verb.trials, share, verb.size, verb=verb.name)]


PART = Part(
    "kills",
    "kill -9 at any moment",
    "Every verb that writes a file or moves the arm is killed with SIGKILL: half of the trials at a random time of its "
    "run, half just before one of the changes that it makes to files or to the board (a killed write has written a "
    "part), so that every state between two changes is met. Half begin with older files in the place of the results. "
    "Every result must be absent, as before, or what a run without a kill writes; a log may also lie beside it, "
    "readable and marked as unfinished, and a journal to go on from. The board must have its motors off within its "
    "lease, and run and keep a whole set that it had or was sent. No program that the verb has started may go on for "
    "ever. From every state that was met the next run must work, and leave nothing hidden. `tune` takes seconds and "
    "`record --excite` moves for four, so they have fewer trials; `identify` and the log of the picture are worked "
    "out once, and the trials begin where the result is written: before, these verbs only look whether they can write "
    "it, as all others do. `calibrate` is killed without the sweeps that a person makes. The boards are in Python "
    "except where it says simulated board: that is the real image.",
    (
        *("host/src/greywhale", "host/native", "sim", "firmware/lib", "firmware/src", "shared/fuzzy_tables"),
        *("tests/board/fake_board.py", "tests/tune/models.py", "tools/bench/recordings.py"),
    ),
    pieces,
    do_piece,
)
