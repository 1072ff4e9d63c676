"""A verb that turns the motors off and on by itself, as calibrate and adapt do, starts none after a stop."""

from __future__ import annotations

import sys
from collections.abc import Callable
from contextlib import closing
from pathlib import Path

import pytest

from greywhale.dashboard.client import Client
from greywhale.dashboard.outbox import Outbox
from greywhale.protocol import schema
from greywhale.protocol.frames import FrameDecoder
from tests.dashboard.shared import Desk, Shared, living

# What the two do on the board, without the person that they wait for. With "lost" no Ctrl-C reaches them.
BEGIN = """
import json, signal, socket, sys
from greywhale.adapt.change import SetChanger
from greywhale.board.calibrate.motors import examine_motor
from greywhale.board.device import Device
from greywhale.board.limits import RECORDING
from greywhale.board.upload import read_parameters, run_set
from greywhale.protocol.lent_line import lend

signal.signal(signal.SIGINT, signal.SIG_IGN if "--out=lost" in sys.argv else signal.default_int_handler)
lend(sys.argv[3], socket.socket(fileno=int(sys.argv[2])))
with Device(sys.argv[3], restart=False) as device:
    table = read_parameters(device)
"""
PULSES = """
    try:
        for joint in (0, 1):
            examine_motor(device, table, joint)
    finally:
        run_set(device, table)
    print(json.dumps({}))
"""
CHANGES = """
    changer = SetChanger(device)
    with device.enabled(RECORDING.busy_lease_ms):
        for ratio in (900, 800, 700):
            wish = table.with_raw({"joint0.ku_mv": table["joint0.ku_mv"] * ratio // 1000})
            while not changer.is_ready(wish):
                changer.prepare(wish)
            changer.change()
    run_set(device, table)
    print(json.dumps({}))
"""
VERBS = {"calibrate": BEGIN + PULSES, "adapt": BEGIN + CHANGES}
PHASES = {"on": 1, "off": 2, "on again": 3}  # of the motors, after so many changes


class Watch:
    """A page that watches each tick. Acts once, in the tick in which the motors have gone on and off so often."""

    def __init__(self, shared: Shared, at: int = 0, act: Callable[[], object] = lambda: None) -> None:
        self.changes = 0
        self.on = False
        self._at, self._act = at, act
        self._decoder = FrameDecoder()
        self.client = Client(Outbox(self._look))
        self.client.every = 1
        shared.relay.join(self.client)

    def _look(self, urgent: bool) -> None:
        _, samples = self.client.outbox.take()
        for frame in self._decoder.feed(samples):
            state = schema.Sample.unpack(frame.payload).state
            on = state not in (schema.State.DISABLED, schema.State.FAULT)
            if on is not self.on:
                self.on, self.changes = on, self.changes + 1
                if self.changes == self._at:
                    self._act()


@pytest.mark.slow
@pytest.mark.parametrize(
    ("verb", "phase", "way"),
    [
        ("calibrate", "on", "its page stops it"),
        ("calibrate", "off", "its card does"),
        ("adapt", "off", "a page that watches does"),
        ("adapt", "on again", "its page is closed"),
    ],
)
def test_a_stop_in_any_phase_is_the_end_of_it(shared: Shared, tmp_path: Path, verb: str, phase: str, way: str) -> None:
    desk = Desk(shared, tmp_path, [sys.executable, "-c", VERBS[verb]])
    lost = phase == "off"  # what it asks next is to start the motors, and alone the server is in its way
    watcher = shared.page(0)
    acts: dict[str, Callable[[], object]] = {
        "its page stops it": lambda: desk.page.ask(schema.StopRequest()),
        "a page that watches does": lambda: watcher.ask(schema.StopRequest()),
        "its card does": lambda: desk.jobs.stop(desk.jobs.facts()[0]["id"]),
        "its page is closed": lambda: shared.relay.leave(desk.page.client),
    }
    watch = Watch(shared, PHASES[phase], acts[way])
    with living(shared), closing(desk.jobs):
        job = desk.run("record", out="lost" if lost else "log.csv")
    assert job["state"] == "stopped", job
    shared.live(0.2)
    assert not watch.on
    assert watch.changes == PHASES[phase] + ("on" in phase), "the motors went off, and stayed so"
