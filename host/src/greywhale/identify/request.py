"""The request for an identification: an arm to start from, and logs that were made ready."""

from __future__ import annotations

from dataclasses import dataclass

from greywhale.arm import ArmParameters
from greywhale.base.errors import UserError
from greywhale.base.types import Progress
from greywhale.identify.closed_loop import Loop
from greywhale.identify.judge import FIT, JudgedLog
from greywhale.identify.limits import IdentificationLimits
from greywhale.protocol.firmware import JOINTS


@dataclass(frozen=True)
class IdentificationRequest:
    """The white box to start from, the logs made ready, and the seed of all random numbers.

    `begin` is an identified model of the same arm, made from other logs, to go on from.
    """

    white_box: ArmParameters
    subjects: tuple[JudgedLog, ...]
    seed: int
    report: Progress
    begin: ArmParameters | None = None

    @property
    def limits(self) -> IdentificationLimits:
        """Those that the logs carry."""
        return self.subjects[0].log.limits

    @property
    def fitted(self) -> tuple[JudgedLog, ...]:
        return tuple(subject for subject in self.subjects if subject.role == FIT)

    @property
    def moving(self) -> tuple[int, ...]:
        """Joints that the motors move in at least one fitted log."""
        return tuple(joint for joint in range(JOINTS) if any(one.log.shown[joint] for one in self.fitted))

    def loops(self) -> list[Loop]:
        """The fitted logs' closed loops, or none where the controller of one is not known."""
        known = [(one.log, one.table) for one in self.fitted if one.table is not None]
        return [Loop(*pair, self.white_box) for pair in known] if len(known) == len(self.fitted) else []

    def required_loops(self) -> list[Loop]:
        """Return the closed loops, for a method that needs them. Raises UserError where there are none."""
        loops = self.loops()
        if not loops:
            raise UserError(
                f"{self.fitted[0].log.log.name}: a search in the closed loop needs the controller that the log was "
                "recorded with; give it with --controller."
            )
        return loops
