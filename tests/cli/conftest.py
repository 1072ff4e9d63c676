"""Verbs in this process: without a wait for a bootloader, and without the ports of this machine."""

from __future__ import annotations

import pytest

from greywhale.board.device import Device


@pytest.fixture(autouse=True)
def _quick_and_alone(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(Device.__init__, "__defaults__", (0.0, 0.5))
    monkeypatch.setattr("greywhale.protocol.ports.find_ports", list)
    monkeypatch.delenv("GREYWHALE_PORT", raising=False)
