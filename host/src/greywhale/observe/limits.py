"""Limits of what is told of outside torques: filters, what counts as moving, doubts, and what counts as a contact."""

from __future__ import annotations

from dataclasses import dataclass

from greywhale.base.limits import MEASURED_ON_ARMS, limit


@dataclass(frozen=True)
class TorqueLimits:
    """Compiled code has a struct of these in this order (observe/observer.h)."""

    filter_s: float = limit(
        0.009,
        "s",
        "time constant of each of three low-passes (27 ms in all): less is noisy, more is late",
        MEASURED_ON_ARMS,
    )
    moving_spreads: float = limit(3.0, "deviations", "a joint moves that is faster than the noise of its speed")
    moving_rad_s: float = limit(0.05, "rad/s", "a slower one counts as at rest: friction may have any value there")
    settle_s: float = limit(0.05, "s", "after a start, a turn or a strike: the filters still show it", MEASURED_ON_ARMS)
    interval: float = limit(1.645, "deviations", "hold 90 % of a normal distribution")
    friction_share: float = limit(0.1, "of the friction", "differs from pose to pose on real gears", MEASURED_ON_ARMS)
    drive_share: float = limit(
        0.02, "of the stall torque", "windings get warm, supplies sag, teeth rub", MEASURED_ON_ARMS
    )
    scale_share: float = limit(
        0.015,
        "of the torque",
        "times all inertia over the links'",
        MEASURED_ON_ARMS,
    )
    loaded_share: float = limit(
        0.02, "of the stall torque", "teeth that pass on less may be apart, if there is a gap", MEASURED_ON_ARMS
    )
    stop_rad: float = limit(0.02, "rad", "a joint that is nearer to its stop may lean on it")
    begin_s: float = limit(
        0.1, "s", "after a start nothing is told: a joint that moves then looks as if it were struck", MEASURED_ON_ARMS
    )
    restart_s: float = limit(0.1, "s", "after a longer gap in the samples all begins anew")
    slow_spreads: float = limit(4.0, "times the moving speed", "a slower joint may be turning within its play")
    play_share: float = limit(1.5, "of the play", "crossed unseen: play is found to a third or so")
    contact_deviations: float = limit(3.3, "deviations", "a larger torque is a contact", MEASURED_ON_ARMS)
    contact_arms: float = limit(0.7, "of the arms", "that could have made the log must say so")
    contact_share: float = limit(0.05, "of the stall torque", "and this much beyond them", MEASURED_ON_ARMS)
    contact_s: float = limit(0.005, "s", "for so long at least", MEASURED_ON_ARMS)
    strike_s: float = limit(0.008, "s", "and for so long where a gap's teeth may strike", MEASURED_ON_ARMS)
    release_s: float = limit(0.05, "s", "a contact has ended when its torque was smaller for so long")


TORQUE_LIMITS = TorqueLimits()
