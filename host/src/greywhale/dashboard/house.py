"""All that one dashboard has to do with: its board, its arm, its folder."""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path
from typing import Any

from greywhale import __version__
from greywhale.dashboard.bench import Hands
from greywhale.dashboard.history import History
from greywhale.dashboard.relay import Relay
from greywhale.protocol import schema


@dataclass
class House:
    """What the server's answers come from."""

    relay: Relay
    folder: Path
    arm: str  # name of a built-in arm or an arm.toml
    bench: Hands | None = None  # the simulated bench, where there is one

    def state(self) -> dict[str, Any]:
        """What a page shows beside the board's own words."""
        link = self.relay.link
        logs = sorted(self.folder.glob("*.csv"), key=lambda path: path.name)
        return {
            "greywhale": __version__,
            "protocol": schema.PROTOCOL,
            "schema": f"{schema.SCHEMA_HASH:#010x}",
            "port": link["port"],
            "open": link["open"],
            "arm": self.arm,
            "folder": str(self.folder),
            "sim": self.bench is not None,
            "files": [path.name for path in logs],
        }


def make_house(folder: Path, arm: str, bench: Hands | None) -> House:
    return House(Relay(History()), folder, arm, bench)
