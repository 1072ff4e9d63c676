"""Checks and helps every test: each error is one whole sentence, children hear signals, and nobody else's temporary
files are in sight. Under `-n`: shares rooms of tests out among workers.
"""

from __future__ import annotations

import gc
import os
import signal
import tempfile
from collections.abc import Generator, Iterator

import pytest
from hypothesis import settings
from xdist.scheduler import LoadScopeScheduling

from greywhale.base import state
from greywhale.base.errors import UserError
from greywhale.base.runtime import VARIABLE
from tests.support.sentences import is_sentence

# What a test finds depends on the code alone: neither on chance nor on the load of the machine.
settings.register_profile("suite", deadline=None, derandomize=True)
settings.load_profile("suite")


def pytest_configure() -> None:
    """A suite in the background of a script, or under nohup, was started with these signals ignored, and every child
    would inherit that. A child does not inherit a handler: for it the signal is as in a terminal."""
    if signal.getsignal(signal.SIGINT) is signal.SIG_IGN:
        signal.signal(signal.SIGINT, signal.default_int_handler)
    if signal.getsignal(signal.SIGHUP) is signal.SIG_IGN:
        signal.signal(signal.SIGHUP, lambda number, frame: None)  # the suite itself outlives its terminal


@pytest.hookimpl(wrapper=True)
def pytest_collection() -> Generator[None, object, object]:
    """Collect without a search for garbage: it would take a third of the time, and a fortieth of that of the tests.

    Collected things live to the end, and tests leave few dead objects in rings.
    """
    gc.disable()
    try:
        return (yield)
    finally:
        gc.freeze()
        gc.set_threshold(50_000, 20, 20)
        gc.enable()


@pytest.fixture(autouse=True)
def _errors_are_sentences(monkeypatch: pytest.MonkeyPatch) -> Iterator[None]:
    """Every error for a user, whatever test causes it. A test then compares only the thing and the value in it."""
    poor: list[str] = []
    construct = UserError.__init__

    def note(error: UserError, *given: object, **options: object) -> None:
        construct(error, *given, **options)  # type: ignore[arg-type] # as they came
        if not is_sentence(error.message):
            poor.append(error.message)

    monkeypatch.setattr(UserError, "__init__", note)
    yield
    assert poor == [], "errors that are no whole sentence"


@pytest.fixture(autouse=True)
def _signal_handlers_as_they_were() -> Iterator[None]:
    """The command line installs its own."""
    before = {number: signal.getsignal(number) for number in (signal.SIGINT, signal.SIGTERM, signal.SIGHUP)}
    yield
    for number, handler in before.items():
        signal.signal(number, handler)


@pytest.fixture(scope="session", autouse=True)
def _temporary_folder_of_our_own(tmp_path_factory: pytest.TempPathFactory) -> Iterator[None]:
    """Nobody shall see what lies or runs in ours, such as benches, and we shall see nobody else's."""
    folder = str(tmp_path_factory.mktemp("tmp"))
    with pytest.MonkeyPatch.context() as patch:
        patch.setenv("TMPDIR", folder)  # for children
        patch.setattr(tempfile, "tempdir", folder)
        patch.setenv(VARIABLE, f"{folder}/run")
        patch.setenv(state.VARIABLE, f"{folder}/state")
        yield


@pytest.fixture(scope="session", autouse=True)
def _no_wait_for_the_disk() -> Iterator[None]:
    """No test cuts the power, and what was written outlives a process without it; programs that tests start do wait."""
    with pytest.MonkeyPatch.context() as patch:
        patch.setattr(os, "fsync", os.fstat)  # a descriptor that is none fails there too
        yield


# Workers begin with these rooms, in this order, so that they end at about the same time. The first two wait for other
# programs, while lint still has a use for the processor.
LONGEST = (
    *("page", "dashboard", "end_to_end", "docs", "board", "commission", "identify", "attack", "tune"),
    *("cli", "paper", "fuzzy", "base", "oracles/test_wheels.py"),
)


def _room(nodeid: str) -> str:
    """tune/judge of tests/tune/judge/test_floor.py::test_a_floor; each file of the oracles is a room."""
    file = nodeid.partition("::")[0].removeprefix("tests/")
    return file if file.startswith("oracles/") else file.rpartition("/")[0]


@pytest.hookimpl(trylast=True)
def pytest_collection_modifyitems(config: pytest.Config, items: list[pytest.Item]) -> None:
    if hasattr(config, "workerinput"):
        items.sort(key=lambda item: _place(_room(item.nodeid)))


def _place(room: str) -> int:
    """The rank by which a worker begins with it; a room within one of LONGEST begins with that one."""
    return next((place for place, one in enumerate(LONGEST) if f"{room}/".startswith(f"{one}/")), len(LONGEST))


class Rooms(LoadScopeScheduling):  # type: ignore[misc] # xdist has no types
    """A worker takes a room at a time: what its tests share is built once, and PlatformIO, which builds in one folder,
    has one user.
    """

    def _split_scope(self, nodeid: str) -> str:
        return _room(nodeid)


def pytest_xdist_make_scheduler(config: pytest.Config, log: object) -> object:
    config.option.loadscopereorder = False  # it would begin with the room that holds most tests
    return Rooms(config, log)
