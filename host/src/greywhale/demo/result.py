"""What the demo found: the measures of every run side by side, for people and as JSON."""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path

from greywhale.measure import Evaluation, JointMeasures
from greywhale.report.follow import JOINT_NAMES

Measure = tuple[str, str, int]  # heading, attribute of JointMeasures, decimals
MEASURES: tuple[Measure, ...] = (
    ("MSE [rad²]", "mse", 6),
    ("steady-state error [rad]", "steady_state_error", 4),
    ("time delay [s]", "delay_s", 3),
)


@dataclass(frozen=True)
class Run:
    """One recording with one set of controllers."""

    name: str
    log: Path
    param_crc: int
    samples: int
    dropped: int
    measures: Evaluation


@dataclass(frozen=True)
class DemoResult:
    """All runs of the demo."""

    leader: str
    board: str
    firmware: str
    runs: tuple[Run, ...]
    picture: Path
    wall_s: float

    def as_dict(self) -> dict[str, object]:
        return {
            "leader": self.leader,
            "board": self.board,
            "firmware": self.firmware,
            "runs": [
                {
                    "controllers": run.name,
                    "log": str(run.log),
                    "parameter_crc": f"0x{run.param_crc:04x}",
                    "samples": run.samples,
                    "dropped": run.dropped,
                    "measures": run.measures.as_dict(),
                }
                for run in self.runs
            ],
            "picture": str(self.picture),
            "wall_s": round(self.wall_s, 1),
        }

    def text(self) -> str:
        """A table a person can read, and where the files are."""
        parts = [f"Leader: {self.leader}. Board: {self.board}, firmware {self.firmware}."]
        parts += [self._table(*measure) for measure in MEASURES]
        files = ", ".join(str(run.log) for run in self.runs)
        parts.append(f"Picture: {self.picture}\nLogs: {files}")
        return "\n\n".join(parts)

    def _table(self, heading: str, attribute: str, decimals: int) -> str:
        width = max(14, *(len(run.name) + 2 for run in self.runs))
        lines = [f"{heading:<26}" + "".join(f"{run.name:>{width}}" for run in self.runs)]
        for joint, name in enumerate(JOINT_NAMES):
            cells = (_cell(run.measures.joints[joint], attribute, decimals) for run in self.runs)
            lines.append(f"  {joint} {name:<22}" + "".join(f"{cell:>{width}}" for cell in cells))
        if attribute == "mse":
            totals = (f"{run.measures.total_mse:.{decimals}f}" for run in self.runs)
            lines.append(f"  {'all joints':<24}" + "".join(f"{cell:>{width}}" for cell in totals))
        return "\n".join(lines)


def _cell(measures: JointMeasures, attribute: str, decimals: int) -> str:
    value: float | None = getattr(measures, attribute)
    return "-" if value is None else f"{value:.{decimals}f}"
