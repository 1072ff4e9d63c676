"""The limits of a commissioning: motions, rounds, what a trial may show, and what a search on the model aims at."""

from __future__ import annotations

from dataclasses import dataclass

from greywhale.base.limits import MEASURED_IN_TRIALS, MEASURED_ON_ARMS, limit
from greywhale.measure.limits import SWING_LIMITS, SwingLimits
from greywhale.tune.limits import BY_THE_ARM, TuningLimits


@dataclass(frozen=True)
class MotionLimits:
    """The little first motion, and the five parts of the check."""

    speed_share: float = limit(0.9, "of what a host can lead", "no move is quicker: a tenth to spare")
    first_rad: float = limit(0.15, "rad", "the first motion is no larger")
    first_again_rad: float = limit(0.4, "rad", "the first motion once more, for joints that friction held")
    first_edge_s: float = limit(0.5, "s", "an edge of the first motion is slow")
    first_hold_s: float = limit(0.7, "s", "each of its stops is long enough to arrive")
    softer_starts: int = limit(
        3,
        "times",
        "a joint that the board stops for swings gets half the voltage",
    )
    least_way_share: float = limit(
        0.25, "of the leader's way", "a joint that went less, or the other way, does not move freely"
    )
    sinking_s: float = limit(0.15, "s", "end of a log in which a sinking joint has one speed")
    small_rad: tuple[float, ...] = limit((0.1, 0.0), "rad", "stops of the small moves, which come first")
    move_shares: tuple[float, ...] = limit(
        (0.9, -0.6, 0.3), "of the room", "stops of the moves; each joint begins at another one"
    )
    hold_s: float = limit(1.3, "s", "a stop of the moves")
    rest_s: float = limit(2.2, "s", "the last stop: a joint may break loose late", MEASURED_ON_ARMS)
    reaches_s: float = limit(5.5, "s", "duration of the reaches, as a hand makes them")
    reaches_share: float = limit(0.8, "of the room", "how far the reaches go")
    slow_s: float = limit(4.0, "s", "one slow swing to both sides: there joints rattle most easily")
    slow_share: float = limit(0.35, "of the room", "how far that swing goes")
    pause_s: float = limit(0.3, "s", "a rest between two parts")
    still_shares: tuple[float, ...] = limit(
        (0.6, -0.5, 0.0), "of the room", "stops of every second joint while the others hold still"
    )
    still_s: float = limit(0.4, "s", "an edge, and a stop, of these moves")


@dataclass(frozen=True)
class RoundLimits:
    """Limits at which a round, or its trials, end."""

    max_error_share: float = limit(0.5, "of the error before", "above this another round follows")
    poor_times: float = limit(
        2.0,
        "times the error",
        "a joint so much worse than promised is poor: right models are 1.8 off at most",
        MEASURED_ON_ARMS,
    )
    poor_error_share: float = limit(
        0.03, "of the error before", "what is below this is not poor, whatever the model says", MEASURED_ON_ARMS
    )
    poor_again_share: float = limit(0.15, "of the error before", "above this another round follows for a poor joint")
    softer_shares: tuple[float, ...] = limit(
        (1.0, 0.5, 0.25),
        "of the way from the controller before to the tuned one",
        "for a joint that ended a trial or was restless twice, one after another",
    )
    good_error_share: float = limit(
        0.04,
        "of the error before",
        "a round ends when the joints' best together are below",
        MEASURED_IN_TRIALS,
    )
    min_gain: float = limit(0.1, "of the error", "or when the last trials gained less than this", MEASURED_IN_TRIALS)
    trials_without_gain: int = limit(3, "trials", "how many trials must gain that", MEASURED_IN_TRIALS)
    max_confirmations: int = limit(12, "trials", "combinations of the joints' best, tried at the end")
    max_model_error: float = limit(
        0.5,
        "of the tracking error (mean squares)",
        "a given model that predicts no better is of another arm",
    )


@dataclass(frozen=True)
class EvidenceLimits:
    """Limits of the evidence that earlier trials give a later round."""

    fitted_trials: int = limit(2, "trials", "logs fitted besides the excitation")
    gaps_rad: tuple[float, ...] = limit(
        (0.002, 0.005, 0.01, 0.02),
        "rad to either side",
        "play or gaps that a model may lack; mildest first",
    )
    hunting_end_s: float = limit(0.8, "s", "the end of a log shows how a joint hunts")
    shown_share: float = limit(0.5, "of the measured unrest", "a plant shows the unrest from this on")


@dataclass(frozen=True)
class StepLimits:
    """Limits of a round's model on steps, which no check can have."""

    max_error_share: float = limit(
        0.99,
        "of the error before",
        "most on steps; the rest is the model's error",
        MEASURED_ON_ARMS,
    )
    believed_share: float = limit(
        0.1, "of the error", "a model that predicts the error before to within this is believed"
    )


@dataclass(frozen=True)
class JudgeLimits:
    """Limits of a joint in a trial; those of its swings are in `measure/limits.py`."""

    bearable_price: float = limit(
        2.0,
        "times the error",
        "price of swinging as much as can be borne",
    )
    repeat_rad: float = limit(
        8e-4,
        "rad rms",
        "or by so much recordings with the same controllers differ: it counts on an arm tuned before",
        MEASURED_IN_TRIALS,
    )
    unseen_rad: float = limit(
        0.002,
        "rad rms",
        "where a joint hardly moves: so much more nobody sees",
    )
    unseen_holding_rad: float = limit(
        0.006,
        "rad rms",
        "at rest friction decides: 1 mrad in one trial, 6 in another",
        MEASURED_IN_TRIALS,
    )
    kept_share: float = limit(
        0.1, "of the error before", "a joint that keeps its controller feels its neighbours' quicker moves"
    )
    kept_growth: float = limit(
        2.0,
        "times before",
        "so much more unrest for such a joint",
    )
    pushed_rad: float = limit(
        0.003,
        "rad rms",
        "quicker neighbours push a joint at rest by 2 to 3 mrad",
        MEASURED_IN_TRIALS,
    )


@dataclass(frozen=True)
class SearchLimits:
    """Limits of a set of controllers on the round's model, before the arm moves."""

    packs: tuple[tuple[float, int], ...] = limit(
        ((0.05, 96), (0.05, 64), (0.03, 64), (0.02, 64)),
        "of the box, and sets",
        "searches, each around the best so far: width of the first pack, sets to try",
    )
    worse_gain: float = limit(1.3, "times", "the worse arm has so much loop gain")
    worse_lag_s: float = limit(1e-3, "s", "the worse arm has so much more lag of the potentiometers")
    gear_sigmas: float = limit(1.0, "standard deviations", "the worse arm's gears are looser by so many")
    unrest_aim: float = limit(0.7, "of the check's limit", "the unrest, or chatter, that a set on the model may show")
    rattle_aim: float = limit(
        0.5, "of the check's limit", "the same of rattling: an arm rattles 1.1 to 2.0 times its model", MEASURED_ON_ARMS
    )
    error_aim: float = limit(0.8, "of the check's limit", "the same of the error")
    before_aim: float = limit(
        0.95,
        "of before",
        "error on steps and ripple: an arm hisses 1.0 to 1.1 times its model",
        MEASURED_ON_ARMS,
    )
    correction_share: float = limit(0.85, "of the arm's limit", "what a trial shows beyond this, the model must lower")
    least_aim: float = limit(0.1, "of an aim", "so much of an aim stays whatever the trials show")
    still_rad: float = limit(
        0.002,
        "rad rms",
        "the unrest between steps, or what was there before",
    )
    max_overshoot: float = limit(15.0, "% of a step", "the overshoot in moves, or as much as before")
    retry_error: float = limit(
        0.5,
        "of the error before (rms)",
        "a joint that keeps more is searched again",
        MEASURED_ON_ARMS,
    )
    price: float = limit(2.0, "times the error before", "of being beyond a limit by all of it")
    steps_price: float = limit(
        20.0,
        "times the error before",
        "the same for steps: with 4 % more a joint does not pass",
        MEASURED_ON_ARMS,
    )
    host_ripple_share: float = limit(
        0.6, "of the ripple under a leader's hand", "is there while a host leads, without the leader's noise"
    )
    least_ki: float = limit(30.0, "V/(rad s)", "where the search begins anew, it has some integral part")


@dataclass(frozen=True)
class CommissioningLimits:
    """All limits of a commissioning; those of swings are the adaptation's too."""

    motion: MotionLimits = MotionLimits()
    rounds: RoundLimits = RoundLimits()
    evidence: EvidenceLimits = EvidenceLimits()
    steps: StepLimits = StepLimits()
    judge: JudgeLimits = JudgeLimits()
    search: SearchLimits = SearchLimits()
    swings: SwingLimits = SWING_LIMITS
    tuning: TuningLimits = BY_THE_ARM


COMMISSIONING_LIMITS = CommissioningLimits()
