"""The simulated bench under a page's hands: a wish becomes one of the bench's own commands (docs/bench.md)."""

from __future__ import annotations

import math
import shlex
import threading
from typing import Any

from greywhale.base.bench_process import RunningBench
from greywhale.base.errors import BadUsage, cut
from greywhale.dashboard.folder import Folder
from greywhale.protocol.firmware import JOINTS

SIDES = ("leader", "follower")


class BenchControls:
    """The controls of the bench for a page; any thread may call them."""

    def __init__(self, bench: RunningBench, folder: Folder) -> None:
        self._bench = bench
        self._folder = folder
        self._lock = threading.Lock()

    def controls(self) -> dict[str, Any]:
        """The controls, each with its range."""
        return self._do("controls")

    def change(self, wish: dict[str, Any]) -> dict[str, Any]:
        """Do one thing; what there is to change then. Of what hands do for a calibration, how long it takes."""
        match wish:
            case {"leader": [_, _, _, _] as angles}:
                self._do(f"lead {' '.join(_number(angle) for angle in angles)}")
                return {}
            case {"turn": int(pot)} if 0 <= pot < 2 * JOINTS:
                return self._do(f"turn {SIDES[pot // JOINTS]} {pot % JOINTS}")
            case {"pose": [_, _, _, _] as angles}:
                return self._do(f"hold {' '.join(_degrees(angle) for angle in angles)}")
            case {"hang": True}:
                return self._do("hang")
            case {"motion": "hold"}:
                self._do(f"lead {' '.join(map(str, self._do('status')['leader']))}")
            case {"motion": str(name)} if name in (one["name"] for one in self.controls()["motions"]):
                self._do(f"leader {name}")
            case {"motion": str(file)}:
                self._do(f"leader {shlex.quote(str(self._folder.file(file)))}")
            case {"fault": None}:
                self._do("mistake none")
            case {"fault": str(name)} if name.isprintable():  # a line is a command
                self._do(f"mistake {shlex.quote(name)}")
            case {"power": bool(on)}:
                self._do(f"power {'on' if on else 'off'}")
            case {"estop": bool(pressed)}:
                self._do(f"estop {'press' if pressed else 'release'}")
            case {"clutch": bool(pressed)}:
                self._do(f"clutch {'press' if pressed else 'release'}")
            case {"supply": volts}:
                self._do(f"supply {_number(volts)}")
            case {"load": mass}:
                self._do(f"load {_number(mass)}")
            case {"speed": rate}:
                self._do(f"speed {_number(rate)}")
            case _:
                keys = "leader, turn, pose, hang, motion, fault, power, estop, clutch, supply, load and speed"
                raise BadUsage(f"{cut(repr(wish))} is nothing that a page does to a bench; it knows {keys}.")
        return self.controls()

    def _do(self, text: str) -> dict[str, Any]:
        with self._lock:
            return self._bench.command(text)


def _degrees(angle: object) -> str:
    return repr(round(math.degrees(float(_number(angle))), 6))


def _number(value: object) -> str:
    try:
        number = math.nan if isinstance(value, bool) or not isinstance(value, int | float) else float(value)
    except OverflowError:  # an integer of hundreds of digits
        number = math.inf
    if not math.isfinite(number):
        raise BadUsage(f"{cut(repr(value))} is no number, and the bench needs one here.")
    return repr(number)
