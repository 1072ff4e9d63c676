"""The folder of what is remembered: the user's, or another that is named."""

from __future__ import annotations

import sys
from pathlib import Path

import pytest

from greywhale.base import state
from greywhale.base.errors import UserError

FOLDERS = {"linux": ".local/state", "darwin": "Library/Application Support", "win32": "AppData/Local"}


@pytest.mark.parametrize("system", FOLDERS)
def test_each_system_has_its_folder_in_the_users_home(system: str, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(sys, "platform", system)
    monkeypatch.setenv("HOME", "/home/ada")
    for name in (state.VARIABLE, "XDG_STATE_HOME", "LOCALAPPDATA"):
        monkeypatch.delenv(name, raising=False)
    assert state.state_directory() == Path("/home/ada") / FOLDERS[system] / "greywhale"
    monkeypatch.setenv(state.VARIABLE, "/elsewhere")
    assert state.state_directory() == Path("/elsewhere")


def test_a_user_without_a_home_is_told_to_name_a_folder(monkeypatch: pytest.MonkeyPatch) -> None:
    def no_home() -> Path:
        raise RuntimeError

    monkeypatch.delenv("XDG_STATE_HOME", raising=False)
    monkeypatch.delenv(state.VARIABLE)
    monkeypatch.setattr(Path, "home", no_home)
    with pytest.raises(UserError, match=state.VARIABLE):
        state.state_directory()
