"""The closed form of docs/arm.md follows from the kinematics, symbol by symbol."""

from __future__ import annotations

import runpy

import pytest

from tools import ROOT

SCRIPT = ROOT / "docs" / "derivation" / "arm.py"


def test_closed_form_equals_the_derivation(capsys: pytest.CaptureFixture[str]) -> None:
    runpy.run_path(str(SCRIPT), run_name="__main__")
    assert capsys.readouterr().out.endswith("The closed form equals the derivation.\n")
