"""The demonstration: the whole of greywhale on the simulated bench in one go."""

from greywhale.base.bench_process import BenchProcess, RunningBench
from greywhale.cli.story.recorder import Recorded, record_motion
from greywhale.cli.story.result import DemoResult
from greywhale.cli.story.story import DemoOptions, run

__all__ = ["BenchProcess", "DemoOptions", "DemoResult", "Recorded", "RunningBench", "record_motion", "run"]
