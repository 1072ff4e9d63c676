"""The limits of an adaptation: what it looks at, when it changes the running set, and what it believes and keeps.

A stretch of work is a second, so lengths in stretches are in seconds.
"""

from __future__ import annotations

from dataclasses import dataclass

from greywhale.base.limits import BY_THE_FIRMWARE, MEASURED_ON_ARMS, limit
from greywhale.measure.limits import SWING_LIMITS, SwingLimits
from greywhale.tune.limits import WITHOUT_FLOORS, TuningLimits


@dataclass(frozen=True)
class ChangeLimits:
    """Limits of a change: the board takes another set over while a person works."""

    stage_every_samples: int = limit(4, "samples", "one parameter is staged so often")
    look_every_samples: int = limit(10, "samples", "a rest is looked for so often")
    rest_samples: int = limit(250, "samples", "rest of leader and follower before a set is changed")
    still_rad: float = limit(0.02, "rad", "a rest keeps within this: a hand trembles")
    close_rad: float = limit(
        0.12,
        "rad",
        "no error is larger at a change, an urgent one too",
    )
    max_off_ticks: int = limit(1000, "ticks", "a change that takes longer went wrong")
    max_first_start_ticks: int = limit(
        12_000, "ticks", "the first soft start, that of the stored set, takes no longer", BY_THE_FIRMWARE
    )
    bump_ticks: int = limit(400, "ticks", "errors are looked at for so long after a change")


@dataclass(frozen=True)
class SampleLimits:
    """Limits of a stretch of samples, and of a record of stretches."""

    max_lost_samples: int = limit(20, "samples", "a longer gap ends the stretch")
    least_swing_record_s: int = limit(4, "s", "shorter records say little about swings")


@dataclass(frozen=True)
class ModelLimits:
    """The fit of the live model to the last stretches."""

    fit_steps: int = limit(8, "steps of least squares", "a fit starts at the last one")
    load_preference: float = limit(
        1.5, "times the misfit", "the other fit must be so much better than that with the load"
    )
    plants: int = limit(3, "plants", "a set is tuned for the estimate and open ones")
    moved_rad: float = limit(0.1, "rad", "a joint shows its friction from this much motion on")
    max_pot_error: float = limit(
        1.35,
        "times",
        "a reading that turns too little or too far by this is doubted: honest wear looked like 1.15 at most",
        MEASURED_ON_ARMS,
    )


@dataclass(frozen=True)
class GainLimits:
    """Limits that tell a gain from chance."""

    lead_s: int = limit(
        4,
        "s",
        "first stretches of a chain do not count: the model begins at rest",
    )
    group_s: int = limit(4, "s", "neighbouring stretches are alike, so this many count as one observation")
    pot_noise_rad2: float = limit(1e-6, "rad²", "smaller errors of a joint (1 mrad rms) are its potentiometer's")


@dataclass(frozen=True)
class ProposalLimits:
    """The motion that a search in the background trains on, and the stretches that it compares its find by."""

    newest_s: int = limit(24, "s", "the model is fitted to these, and trained on their motion")
    row_every_ticks: int = limit(5, "ticks", "the motion has a row so often; noise is averaged between")
    faster: float = limit(
        1.5,
        "times the speed",
        "the way back is trained quicker: for a person who hurries",
        MEASURED_ON_ARMS,
    )
    block_s: int = limit(8, "s", "older stretches join the comparison so many at a time")
    same_arm_log: float = limit(
        0.4,
        "as a logarithm",
        "older stretches join while the model explains their errors to this factor",
    )


@dataclass(frozen=True)
class DecisionLimits:
    """Limits by which a set is searched, tried, kept and given up."""

    keep_s: int = limit(60, "s", "so much of the work is kept")
    first_search_s: int = limit(20, "s", "seen with the running set before a search")
    between_searches_s: int = limit(10, "s", "so much new work lies between two searches")
    work_rad: float = limit(0.2, "rad", "a search needs a person at work: a leader went this far")
    context_s: int = limit(
        8,
        "s",
        "before the judged stretch: an integral takes time to build up",
    )
    fit_s: int = limit(12, "s", "the model is fitted to so much while another set runs; a verdict needs one no older")
    refit_every_s: int = limit(8, "s", "it is fitted anew so often then")
    max_trial_s: int = limit(60, "s", "a trial that says nothing by then ends")
    trial_swings_s: int = limit(20, "s", "so much of a trial is looked at for swings")
    window_s: int = limit(30, "s", "an excess counts over this time, half a minute")
    max_excess: float = limit(0.20, "of the error", "the error may exceed the first set's by so much over the window")
    alert_excess: float = limit(
        0.10,
        "of the error",
        "a set on trial goes back; by chance half a minute differs by 0.05",
        MEASURED_ON_ARMS,
    )
    model_sigma: float = limit(0.04, "as a logarithm", "a model's ratio of two sets is wrong by this much")
    error_memory: float = limit(0.5, "of the error", "so much of the last promise's error counts for the next")
    sigmas: float = limit(2.0, "standard deviations", "a proposal must be better by so many")
    min_gain: float = limit(0.03, "of the error", "a set is kept that is better by this for certain")
    max_log_misfit: float = limit(
        0.7, "as a logarithm", "a model that misses a joint's error by more does not know the arm"
    )


@dataclass(frozen=True)
class AdaptationLimits:
    """All limits of an adaptation; those of swings are the commissioning's too."""

    changes: ChangeLimits = ChangeLimits()
    samples: SampleLimits = SampleLimits()
    model: ModelLimits = ModelLimits()
    gain: GainLimits = GainLimits()
    proposals: ProposalLimits = ProposalLimits()
    decisions: DecisionLimits = DecisionLimits()
    swings: SwingLimits = SWING_LIMITS
    tuning: TuningLimits = WITHOUT_FLOORS


ADAPTATION_LIMITS = AdaptationLimits()
