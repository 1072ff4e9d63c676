"""The order of the set-up: what runs side by side shares nothing, and a step runs again only when it must."""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path

import pytest

from tools.setup import __main__ as setup
from tools.setup import extensions, firmware, page, page_modules, paper, platformio, stamps, system, venv
from tools.setup.console import SetupError
from tools.setup.goal import Goal


@pytest.fixture
def done(monkeypatch: pytest.MonkeyPatch) -> list[str]:
    """Names of the steps that the set-up takes, in place of doing them."""
    taken: list[str] = []

    def note(name: str) -> Callable[..., None]:
        return lambda *given, **named: taken.append(name)

    def one_by_one(*branches: Callable[[], None]) -> None:
        taken.append("{")
        for branch in branches:
            branch()
        taken.append("}")

    for room in (firmware, page, page_modules, paper, platformio, system, venv):
        monkeypatch.setattr(room, "step", note(room.__name__.rpartition(".")[2]))
    monkeypatch.setattr(extensions, "build", note("extensions"))
    monkeypatch.setattr(extensions, "install", note("installation"))
    monkeypatch.setattr(platformio, "choose", lambda: "pypi")
    monkeypatch.setattr(setup, "side_by_side", one_by_one)
    return taken


@pytest.mark.parametrize("goal", Goal)
def test_the_venv_is_whole_before_anything_uses_it_and_written_by_nobody_meanwhile(done: list[str], goal: Goal) -> None:
    setup.steps(goal)
    before, beside, after = done[:2], done[done.index("{") + 1 : done.index("}")], done[done.index("}") + 1 :]
    assert before == ["system", "venv"]
    assert set(beside) == {"extensions", "platformio", "firmware", *(["page", "page_modules"] if goal else [])}
    assert not goal or beside.index("page_modules") < beside.index("page"), "which takes one of them along"
    assert after == ["installation", "paper"]


def test_a_build_leaves_the_venv_alone(monkeypatch: pytest.MonkeyPatch, tmp_path: Path) -> None:
    commands: list[list[str]] = []
    monkeypatch.setattr(stamps, "STAMPS", tmp_path)
    monkeypatch.setattr(extensions, "WHEELS", tmp_path)
    monkeypatch.setattr(extensions, "run", lambda command, **named: commands.append([str(word) for word in command]))
    extensions.build(checks=False)
    assert len(commands) == 1
    assert not any("pip" in command for command in commands)


def test_a_folder_of_any_name_is_named_in_ascii(monkeypatch: pytest.MonkeyPatch, tmp_path: Path) -> None:
    """Else Python ends at its start where LC_ALL is C."""
    site = tmp_path / "größe" / ".venv/lib/python3/site-packages"
    site.mkdir(parents=True)
    monkeypatch.setattr(venv, "site_packages", lambda: site)
    pth = site / "_editable_skbc_greywhale.pth"
    pth.write_text(f"import _editable_skbc_greywhale\n{tmp_path / 'größe' / 'host/src'}", encoding="utf-8")
    extensions.name_places_from_here()
    assert pth.read_bytes() == b"import _editable_skbc_greywhale\n../../../../host/src\n"


def test_what_was_done_strictly_serves_everybody(monkeypatch: pytest.MonkeyPatch, tmp_path: Path) -> None:
    monkeypatch.setattr(stamps, "STAMPS", tmp_path / "stamps")
    stamps.set_current("step", "inputs", strict=False)
    assert (stamps.is_current("step", "inputs"), stamps.is_current("step", "inputs", strict=True)) == (True, False)
    stamps.set_current("step", "inputs", strict=True)
    assert (stamps.is_current("step", "inputs"), stamps.is_current("step", "inputs", strict=True)) == (True, True)
    assert not stamps.is_current("step", "others")


@pytest.mark.parametrize(
    ("registry", "pypi", "source"), [(True, True, "registry"), (False, True, "pypi"), (False, False, "system")]
)
def test_the_compiler_is_platformios_else_the_same_from_pypi_else_the_systems(
    monkeypatch: pytest.MonkeyPatch, tmp_path: Path, registry: bool, pypi: bool, source: str
) -> None:
    monkeypatch.setattr(stamps, "STAMPS", tmp_path)
    monkeypatch.delenv(platformio.BY_HAND, raising=False)
    monkeypatch.setattr(platformio, "registry_answers", lambda: registry)
    monkeypatch.setattr(platformio, "pypi_has_compiler", lambda: pypi)
    assert platformio.choose() == source


def test_a_choice_by_hand_that_there_is_not_is_named(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setenv(platformio.BY_HAND, "debian")
    with pytest.raises(SetupError, match="GREYWHALE_PLATFORMIO is 'debian': it can be registry, pypi, system"):
        platformio.choose()


def test_a_folder_that_cannot_be_written_is_named(monkeypatch: pytest.MonkeyPatch, tmp_path: Path) -> None:
    (tmp_path / "build").write_text("a file")
    monkeypatch.setattr(setup, "ROOT", tmp_path)
    with pytest.raises(SetupError, match="build cannot be written"), setup.lock_folder():
        pass
