"""The port's findings, and the rules that mend a permission."""

from __future__ import annotations

import os
import pty
import re
from pathlib import Path

import pytest

from greywhale.base import system
from greywhale.board.doctor import port as doctor_port
from greywhale.board.doctor.finding import Verdict
from greywhale.board.doctor.port import examine_port, udev_rules
from tests.board.port_board import opened


@pytest.fixture
def terminal() -> str:
    _, slave = pty.openpty()
    return os.ttyname(slave)


def test_what_is_no_port_is_bad_and_nothing_else_is_asked(tmp_path: Path) -> None:
    (tmp_path / "file").touch()
    for name, says in (("none", "There is no port"), ("file", "not a serial port")):
        (found,) = examine_port(str(tmp_path / name))
        assert found.verdict is Verdict.BAD
        assert says in found.says


def test_a_port_that_may_be_opened_is_good(terminal: str) -> None:
    assert [one.verdict for one in examine_port(terminal)] == [Verdict.GOOD, Verdict.GOOD]


def test_other_programs_at_the_port_are_a_note(terminal: str, monkeypatch: pytest.MonkeyPatch) -> None:
    with opened(terminal) as process:
        found = examine_port(terminal)[-1]
    assert found.verdict is Verdict.NOTE
    assert f"open in process {process} (" in found.says
    monkeypatch.setattr(doctor_port, "meddler", lambda port: "run `greywhale udev`, which helps")
    found = examine_port(terminal)[-1]
    assert (found.verdict, found.remedy) == (Verdict.NOTE, "Run `greywhale udev`, which helps.")


@pytest.mark.parametrize(
    ("group", "says"), [("dialout", "`sudo usermod -aG dialout $USER`"), ("root", "`greywhale udev | sudo tee")]
)
def test_without_permission_the_remedy_names_the_ports_own_group(
    terminal: str, group: str, says: str, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(os, "access", lambda path, mode: False)
    monkeypatch.setattr(system, "group_of", lambda port: group)
    found = examine_port(terminal)[-1]
    assert found.verdict is Verdict.BAD
    assert found.remedy.startswith(says)


def test_every_rule_is_one_that_udev_understands() -> None:
    """Matches with ==, assignments with =, one rule a line, as udev(7) has it."""
    match = r'(SUBSYSTEM|ATTRS\{id(Vendor|Product)\})=="[0-9a-z]+"'
    set_ = r'(MODE="0660"|TAG\+="uaccess"|ENV\{ID_MM_(DEVICE|PORT)_IGNORE\}="1")'
    rules = [line for line in udev_rules().splitlines() if not line.startswith("#")]
    assert len(rules) >= 5
    assert all("ID_MM_DEVICE_IGNORE" in rule and "ID_MM_PORT_IGNORE" in rule for rule in rules), "of whole and of port"
    for rule in rules:
        assert re.fullmatch(rf"{match}(, {match})+(, {set_})+", rule), rule


def test_uaccess_works_only_before_the_rules_of_the_seats() -> None:
    """systemd's 73-seat-late.rules acts on the tag, so the file's number must be lower."""
    number = re.match(r"\d+", Path(doctor_port.RULES_FILE).name)
    assert number is not None
    assert int(number.group()) < 73
