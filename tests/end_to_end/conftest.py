"""The real firmware on the simulated board: behind a serial port in a process of its own, or stepped in lock step."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from greywhale.cli.story import BenchProcess
from greywhale.files.leader import save_leader
from greywhale.files.trajectory import Trajectory
from greywhale.protocol import schema
from greywhale.protocol.declared import Reply_co, Request
from greywhale.protocol.frames import FrameDecoder, encode_frame
from greywhale_sim.assemble import BenchOptions, build_bench
from greywhale_sim.bench import Bench


class LockStep:
    """A host without a wall clock: sends a request and simulates until the answer is there. Deterministic."""

    def __init__(self, bench: Bench) -> None:
        self.bench = bench
        self.board: Any = bench.board
        self.samples: list[schema.Sample] = []
        self.sent = 0
        self._decoder = FrameDecoder()
        self._frames: list[Any] = []
        self._sequence = 0

    def run(self, seconds: float) -> None:
        """Simulate, and collect what the board says."""
        self.bench.run(seconds)
        for frame in self._decoder.feed(self.board.uart_receive()):
            if frame.type == schema.Sample.TYPE:
                self.samples.append(schema.Sample.unpack(frame.payload))
            else:
                self._frames.append(frame)

    def boot(self) -> schema.HelloReply:
        """Until the firmware has come up and said hello by itself."""
        for _ in range(400):
            self.run(0.01)
            for frame in self._frames:
                if frame.type == schema.HelloReply.TYPE and frame.seq == 0:
                    self._frames.clear()
                    return schema.HelloReply.unpack(frame.payload)
        raise AssertionError("no hello within 4 s of simulated time")

    def send(self, request: Request[Any]) -> int:
        self._sequence = self._sequence % 255 + 1
        self.board.uart_send(encode_frame(request.TYPE, self._sequence, request.pack()))
        return self._sequence

    def ask(self, request: Request[Reply_co]) -> Reply_co:
        sequence = self.send(request)
        for _ in range(100):
            self.run(0.001)
            answers = [frame for frame in self._frames if frame.seq == sequence]
            self._frames.clear()
            if answers:
                assert answers[0].type != schema.Nack.TYPE, schema.Nack.unpack(answers[0].payload)
                return request.reply(answers[0].payload)
        raise AssertionError(f"no answer to {request.NAME} within 0.1 s of simulated time")

    def status(self) -> schema.StatusReply:
        return self.ask(schema.StatusRequest())

    def follow(self, lease_ms: int = 0) -> None:
        """Enable the motors and wait until the soft start is over."""
        self.ask(schema.EnableRequest(lease_ms))
        for _ in range(200):
            self.run(0.01)
            if self.status().state is schema.State.FOLLOWING:
                return
        raise AssertionError(f"not following within 2 s: {self.status()}")


def waving(seconds: float = 3.0, amplitude: float = 0.4) -> Trajectory:
    """All joints swing around a pose of their own, half a turn a second; they start at rest."""
    time_s = np.arange(round(seconds * 100) + 1) / 100
    swing = amplitude * (1 - np.cos(np.pi * time_s)) / 2
    return Trajectory(time_s, swing[:, None] * np.array([1.0, -1.0, 1.0, -1.0]) + np.array([0.1, 0.6, -0.3, 0.2]))


@pytest.fixture(scope="session")
def leader_file(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """A short motion for benches in a process of their own."""
    path = tmp_path_factory.mktemp("leader") / "leader.csv"
    save_leader(path, waving())
    return path


@pytest.fixture(scope="session", params=["mega", "nano"])
def board_name(request: pytest.FixtureRequest) -> str:
    return str(request.param)


LockStepFactory = Callable[..., LockStep]


@pytest.fixture
def lock_step(leader_file: Path) -> LockStepFactory:
    """Makes a bench in this process, booted."""

    def make(board: str = "mega", boot: bool = True, **options: Any) -> LockStep:
        host = LockStep(build_bench(BenchOptions(**{"board": board, "leader": leader_file, **options})))
        if boot:
            host.boot()
        return host

    return make


@pytest.fixture
def start_bench(leader_file: Path) -> Iterator[Callable[..., BenchProcess]]:
    """Starts benches in processes of their own, as fast as possible, and ends them after the test."""
    running: list[BenchProcess] = []

    def start(*options: str, board: str = "mega") -> BenchProcess:
        bench = BenchProcess("--board", board, "--speed", "max", "--leader", str(leader_file), *options)
        running.append(bench)
        return bench

    yield start
    for bench in running:
        bench.close()
