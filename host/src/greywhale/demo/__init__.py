"""The demonstration: the whole of greywhale on the simulated bench in one go."""

from greywhale.demo.bench import BenchProcess, RunningBench
from greywhale.demo.recorder import Recorded, record_motion
from greywhale.demo.result import DemoResult
from greywhale.demo.story import DemoOptions, run

__all__ = ["BenchProcess", "DemoOptions", "DemoResult", "Recorded", "RunningBench", "record_motion", "run"]
