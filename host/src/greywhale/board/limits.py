"""Limits of a connected board: patience with it, leading, recording, and from where on its doctor finds something."""

from __future__ import annotations

from dataclasses import dataclass

from greywhale.base.limits import BY_THE_FIRMWARE, limit


@dataclass(frozen=True)
class PatienceLimits:
    """Times after which a board, or a session that holds it, is asked again or given up."""

    reply_wait_s: float = limit(0.3, "s", "a request without an answer is repeated, unchanged: every one may be")
    request_attempts: int = limit(5, "times", "so a silent board is given up after 1.5 s")
    stop_repeat_s: float = limit(0.02, "s", "a stop is repeated sooner, for as long: damage may cost some repeats")
    quiet_s: float = limit(2.0, "s", "a bootloader to which nobody spoke has started the firmware")
    patience_s: float = limit(5.0, "s", "a port that says nothing is greeted, counted from its opening")
    save_wait_s: float = limit(10.0, "s", "a whole set takes 0.7 s to write into the EEPROM of an Arduino")
    silence_s: float = limit(2.0, "s", "without a sample, and five sample periods, something is wrong")
    pause_s: float = limit(1.0, "s", "a host that looks more seldom was stopped itself (Ctrl-Z, a sleeping laptop)")
    renewals_per_lease: int = limit(4, "renewals", "so three may be lost")
    heard_s: float = limit(3.0, "s", "a session hears a stop within it, or is itself stopped (Ctrl-Z) or hung")
    confirm_s: float = limit(5.0, "s", "it then answers within it, or says that the board does not confirm")
    most_clients: int = limit(64, "clients", "wait to be let in, and so many have said nothing yet")


@dataclass(frozen=True)
class LeadLimits:
    """Leading: points of a motion that this host sends ahead, and the pace of a follower that lags."""

    room_points: int = limit(12, "points", "the board can keep so many", BY_THE_FIRMWARE)
    at_once_points: int = limit(2, "points", "more would crowd samples out of the board's transmitter")
    patience_ticks: int = limit(100, "ticks", "without an answer, the points since the last answer are sent again")
    retry_ticks: int = limit(32, "ticks", "answers that take nothing new show a gap, but old ones say so meanwhile")
    approach_rad_s: float = limit(0.5, "rad/s", "the largest speed from the arm's pose to a motion's first")
    slows_share: float = limit(0.5, "of the tracking limit", "a follower so far away slows the motion down")
    stops_share: float = limit(0.8, "of the tracking limit", "one so far away stops it")
    pace_step: float = limit(0.1, "of the pace", "from point to point: from full to none in a sixth of a second")
    longest_ratio: float = limit(3.0, "times its length", "an arm that takes so long cannot follow a motion")


@dataclass(frozen=True)
class HuntingLimits:
    """Hunting that stops a led arm at once; `measure/limits.py` says which swings."""

    window_s: float = limit(0.8, "s", "swings are counted in it")
    look_every_samples: int = limit(40, "samples", "they are counted so often")
    settle_s: float = limit(0.4, "s", "a follower may still be on its way after its leader stopped")
    still_rad: float = limit(0.02, "rad", "a leader that moves less does not lead")


@dataclass(frozen=True)
class RecordingLimits:
    """Lengths and leases of recordings."""

    lease_ms: int = limit(500, "ms", "the motors go off so long after this host falls silent")
    busy_lease_ms: int = limit(1000, "ms", "a computer that also searches may stand still for longer")
    longest_every_enabled_ticks: int = limit(100, "ticks", "rarer samples could not renew a lease in time")
    longest_every_led_ticks: int = limit(4, "ticks", "with rarer ones a host that leads is late with its points")
    longest_every_ticks: int = limit(65535, "ticks", "the request has 16 bits", BY_THE_FIRMWARE)
    shortest_s: float = limit(0.01, "s", "of a recording")
    longest_s: float = limit(86400.0, "s", "a day")
    rest_s: float = limit(0.3, "s", "the log goes on after a motion")
    enable_ticks: int = limit(1000, "ticks", "after enable the samples must show that the motors started")
    most_lost_share: float = limit(0.1, "of a recording", "if more is lost at its end, it is not what was asked for")
    most_lost_samples: int = limit(10, "samples", "and more than these")


@dataclass(frozen=True)
class CalibrationLimits:
    """Calibrating with a person."""

    shown_every_ticks: int = limit(100, "ticks", "a live reading every tenth of a second")
    longest_ticks: int = limit(600_000, "ticks", "ten minutes: so much is kept, and a script is waited for")
    held_ticks: int = limit(500, "ticks", "a pose is looked at")
    script_tries: int = limit(3, "times", "a script's pose is refused before it fails")


@dataclass(frozen=True)
class DoctorLimits:
    """Findings of `greywhale doctor`; potentiometers are in counts of the converter."""

    supply_share: float = limit(0.1, "of the voltage", "a battery differs by so much between full and flat")
    eeprom_writes: int = limit(100_000, "writes", "of one cell, by the chip's data sheet")
    many_saves: int = limit(50_000, "saves", "half of these: time to plan another board")
    link_s: float = limit(10.0, "s", "the link is tried")
    rest_s: float = limit(2.0, "s", "the arm is watched at rest")
    mean_ticks: int = limit(100, "ticks", "whole periods of 50 and of 60 Hz, so that hum stays out of the mean")
    moved_counts: float = limit(8.0, "counts", "a mean wanders farther: somebody moves the arm")
    median_ticks: int = limit(9, "ticks", "a jump is told from the median of its neighbourhood")
    jump_counts: float = limit(6.0, "counts", "a jump leaves it by so much")
    jump_noise_ratio: float = limit(8.0, "times the usual noise", "and by this")
    much_noise_counts: float = limit(1.5, "counts rms", "one count is the converter's own step")
    most_noise_counts: float = limit(4.0, "counts rms", "a joint of 300 degrees then follows to 5 mrad")
    alike_correlation: float = limit(0.7, "", "two that wander so are one: an open input keeps the charge before it")
    alike_counts: float = limit(3.0, "counts", "and stand together")
    hum_hz: tuple[float, float] = limit((50.0, 60.0), "Hz", "of the mains")
    much_hum_counts: float = limit(1.5, "counts", "amplitude, its first harmonic included")


PATIENCE = PatienceLimits()
LEAD = LeadLimits()
HUNTING = HuntingLimits()
RECORDING = RecordingLimits()
CALIBRATION = CalibrationLimits()
DOCTOR = DoctorLimits()
