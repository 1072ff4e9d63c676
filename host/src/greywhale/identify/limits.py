"""The limits of an identification: what a log must be, what a search takes for better, and what a model leaves open.

`identify(..., judging=...)` takes others; every log made ready carries them. Numbers of steps and simulations, and how
finely something is computed, are no limits: they stand where they are used.
"""

from __future__ import annotations

from dataclasses import dataclass

from greywhale.base.limits import MEASURED_ON_ARMS, limit


@dataclass(frozen=True)
class DataLimits:
    """A log made ready: its stretches, velocities and windows."""

    window_s: float = limit(0.5, "s", "length of a window, simulated from a known start")
    gear_window_s: float = limit(
        0.15, "s", "the same where gears are fitted: soon chance decides where a joint is that knocks about in its gap"
    )
    smoothing_s: float = limit(0.04, "s", "the angle is smoothed over this to find velocities")
    led_s: float = limit(0.1, "s", "before a window the log leads the links: motors come to theirs")
    compared_s: float = limit(5e-3, "s", "between compared readings: closer ones differ in noise only")
    usual_spacings: float = limit(99.0, "%", "the longest step holds in so many of the spacings between rows")
    sure_rad_s: float = limit(0.05, "rad/s", "a slower joint may turn back within its potentiometer's play unseen")
    longest_gap_s: float = limit(0.02, "s", "rows further apart (or 1.5 periods of a slower log) end a stretch")
    block_s: float = limit(0.5, "s", "length of a held-out block: shorter than a motion")
    held_out_every: int = limit(4, "blocks", "the last of so many is held out")
    lively_rad: float = limit(0.01, "rad", "in a lively window a joint moves by more than this")
    max_windows: int = limit(120, "windows", "more would take longer, and hardly tell more")
    max_gear_windows: int = limit(240, "windows", "the same of the short ones that gears are fitted to")


@dataclass(frozen=True)
class CheckLimits:
    """Limits beyond which a log is useless."""

    shortest_s: float = limit(4.0, "s", "less of a log shows too little")
    farthest_s: float = limit(0.1, "s", "rows further apart do not show how an arm moves")
    clipped_share: float = limit(0.01, "of the log", "a reading so long at its extreme, far out, is clipped")
    clipped_from_rad: float = limit(2.3, "rad", "so far out: there a potentiometer ends")
    against: float = limit(
        -0.3, "correlation of error and voltage", "below this a controller pushes away from its leader"
    )
    saturated_share: float = limit(0.5, "of the log", "longer at full voltage is worth a remark")
    fitting_share: float = limit(
        0.7, "of the changes", "at least so much of the voltage changes in whole control periods"
    )
    max_shared: float = limit(
        0.2,
        "of the shorter log",
        "logs may share this: those of the bench may begin alike",
    )


@dataclass(frozen=True)
class WindowLimits:
    """Limits for the comparison of a model with a window, or with the closed loop."""

    speed_doubt_rad_s: float = limit(0.05, "rad/s", "a start speed may be off by this beyond its noise")
    worth_a_change: float = limit(0.95, "of the squared difference", "a start on the gap's other side must leave less")
    usual_misfit: float = limit(
        4.0,
        "times the mean window's",
        "a window counts as usual up to this; the median window may be one of rest",
    )
    loop_doubt_rad: float = limit(1e-2, "rad", "one standard deviation of the closed loop's difference, which lasts")


@dataclass(frozen=True)
class SearchLimits:
    """Limits by which a search takes a model for better."""

    min_improvement: float = limit(
        0.01, "of 1 + squares over noise", "an order with more quantities must predict held-out data better by this"
    )
    min_closed_improvement: float = limit(
        0.2, "of the error", "the same for the closed loop: chance alone moves its error by a tenth"
    )
    rival_margin: float = limit(
        0.02, "of 1 + squares over noise", "other orders that are worse by no more are kept as rivals"
    )
    max_rivals: int = limit(2, "models", "so many rivals are kept")
    lossy_drivers: float = limit(
        0.05,
        "of 1 + squares over noise",
        "drivers that lose volts must predict so much better: friction may look like them",
    )
    soft_teeth: float = limit(
        0.05,
        "of log(1 + squares over noise)",
        "teeth that bend start a fit where they alone predict so much better",
    )
    knocking: float = limit(
        1.0,
        "of log(1 + squares over noise)",
        "a joint that windows miss by more may knock about in its gap",
    )
    knocking_gain: float = limit(
        0.02,
        "of log(1 + squares over noise)",
        "its gear is fitted to short windows where they are so much better predicted then",
    )
    other_optimum: float = limit(0.3, "of a searched number", "numbers that differ by this get a fit of their own")
    far_doubts: float = limit(
        1.645,
        "of the arm file's doubts",
        "a torque per volt farther off is fitted from nearer by, too, and stays if the log tells it",
    )
    farthest_log: float = limit(
        2.5, "as a logarithm", "GWO-WOA searches no farther from the arm file's value, to either side"
    )


@dataclass(frozen=True)
class JudgeLimits:
    """Limits beyond which a model is doubted."""

    max_unexplained: float = limit(
        0.5,
        "of the tracking error",
        "more left with a changed controller makes a joint doubted",
    )
    worse_times: float = limit(4.0, "times", "if it is also so many times what its own leaves")
    small_rad: float = limit(5e-3, "rad", "below this error nobody cares which arm is nearer")
    sure_share: float = limit(
        0.95,
        "of the models that a fit allows",
        "a model further off than these is not so by chance",
    )


@dataclass(frozen=True)
class UncertaintyLimits:
    """Limits up to which a quantity is known, and the errors of fits beyond their scatter."""

    open_log: float = limit(0.3, "as a logarithm", "a positive quantity known no better is left open")
    open_steps: tuple[tuple[str, float], ...] = limit(
        (
            ("breakaway", 0.5),
            ("gap", 2e-3),
            ("play", 2e-3),
            ("load", 0.2),
            ("creep", 0.05),
            ("lag", 1e-3),
            ("lost", 0.2),
            ("uneven", 0.1),
            ("sag", 0.3),
            ("tip", 0.05),
            ("offset", 0.05),
        ),
        "in its unit",
        "any other quantity is left open beyond this deviation",
    )
    open_factors: tuple[tuple[str, float], ...] = limit(
        (("drag", 1.0), ("teeth", 1.0), ("ringing", 1.0)),
        "as a logarithm",
        "these matter little: within a factor of e is enough",
    )
    wide_difference: float = limit(
        0.1,
        "of the arm file's doubt",
        "derivatives are wide: hunting makes the residual rough",
    )
    uncertain: float = limit(0.05, "of the value", "numbers that are less certain may lie on a ridge")
    sharper: float = limit(3.0, "times as certain", "a combination so much surer than either number is stated")
    mass_share: float = limit(0.1, "of a link's mass", "an arm file's may be off by this: cables and screws")
    length_share: float = limit(0.02, "of a link's length", "an arm file's may be off by this: 3 mm of 15 cm")
    start_sigmas: float = limit(2.0, "standard deviations", "a fit of a simulated log starts so far away")
    shape_logs: float = limit(3.0, "logs", "the formula counts like so many fits of simulated logs")
    systematic: tuple[tuple[str, float], ...] = limit(
        (
            ("inertia", 0.015),
            ("damping", 0.002),
            ("coulomb", 0.008),
            ("breakaway", 0.03),
            ("stribeck", 0.3),
            ("gap", 2e-4),
            ("drag", 2.0),
            ("teeth", 0.7),
            ("play", 6e-4),
        ),
        "standard deviations of the searched numbers",
        "fits are off beyond their scatter: the real one ends in one of several optima",
        MEASURED_ON_ARMS,
    )
    foreign: tuple[tuple[str, float], ...] = limit(
        (("damping", 0.0022), ("coulomb", 0.0127), ("play", 9e-4)),
        "standard deviations of the searched numbers",
        "besides, on arms of another engine; for people, no plant is drawn with it",
        MEASURED_ON_ARMS,
    )
    creeping: tuple[tuple[str, float], ...] = limit(
        (("damping", 0.1), ("coulomb", 0.25), ("play", 0.027)),
        "times the creep in rad/s",
        "the same where a joint creeps: another law of creep takes its share of these",
        MEASURED_ON_ARMS,
    )
    gap_beside_play_rad: float = limit(
        1.8e-3,
        "rad, a standard deviation",
        "the same of half a gap beside play: both hide a turn of the motor, and how teeth strike differs by engine",
        MEASURED_ON_ARMS,
    )
    systematic_alpha: tuple[float, ...] = limit(
        (0.03, 0.001, 0.001, 3.0),
        "of joints 0 to 3",
        "the same of alpha: yaw and roll feel no gravity and hardly show it",
        MEASURED_ON_ARMS,
    )
    widened: float = limit(
        1.3, "times the variance", "what fits are off on known arms on top of that", MEASURED_ON_ARMS
    )


@dataclass(frozen=True)
class ExcitationLimits:
    """Limits of a designed motion."""

    reach_rad: float = limit(1.0, "rad", "without a range, the way to either side")
    margin_rad: float = limit(0.1, "rad", "distance to the board's limits and the arm's stops")
    narrowest_rad: float = limit(0.2, "rad", "a narrower range shows nothing")
    speed_share: float = limit(0.5, "of the voltage", "speed may take this")
    acceleration_share: float = limit(0.5, "of the voltage", "acceleration may take this")
    max_speed_rad_s: float = limit(4.0, "rad/s", "most speed, and two thirds of what a host can lead")
    lag_share: float = limit(
        0.4,
        "of the board's tracking limit",
        "the most lag in simulation; the player slows from half of the limit on",
    )
    usual_tracking_rad: float = limit(0.9, "rad", "that limit where the board has none, or a wider one")
    motor_doubt_log: float = limit(0.7, "as a logarithm", "a motion is tried on arms whose motors are off by this")
    friction_v: tuple[float, float] = limit((0.2, 0.9), "V", "friction of the arms on which a motion is tried")
    unsafe_price: float = limit(50.0, "", "of a lag or an overshoot of twice the limit: more than any information")
    shrink: float = limit(0.9, "times", "a motion unsafe on some arm shrinks towards the pose by this, again and again")
    still_rad_s: float = limit(0.01, "rad/s", "slower, friction may have any value and shows nothing")
    frequencies_hz: tuple[float, float] = limit((0.1, 3.0), "Hz", "the lowest and the highest sine")
    fade_s: float = limit(1.5, "s", "fading in and out takes this long")
    fade_share: float = limit(0.2, "of the motion", "and at most this much of a short motion")
    rest_s: float = limit(0.3, "s", "the motion rests before and after")
    pauses_per_s: float = limit(0.2, "1/s", "standstills, which show friction at rest, creeping and hunting")
    pause_s: float = limit(1.2, "s", "of such a pause, from slowing down to speed again")
    amplitude_spread_log: float = limit(
        3.0, "as a logarithm", "amplitudes differ by up to this factor, before frequency"
    )


@dataclass(frozen=True)
class IdentificationLimits:
    """All limits of an identification, and of the motion that is designed for one."""

    data: DataLimits = DataLimits()
    checks: CheckLimits = CheckLimits()
    windows: WindowLimits = WindowLimits()
    search: SearchLimits = SearchLimits()
    judge: JudgeLimits = JudgeLimits()
    uncertainty: UncertaintyLimits = UncertaintyLimits()
    excitation: ExcitationLimits = ExcitationLimits()


IDENTIFICATION_LIMITS = IdentificationLimits()
