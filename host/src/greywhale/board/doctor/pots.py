"""The potentiometers of an arm that nobody moves: rails, jumps, noise, hum.

Counts are those of the 10-bit converter after the firmware's low-pass, a row a millisecond, with fractions.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
import scipy  # loads a part of itself when it is first used

from greywhale.base.types import Floats
from greywhale.board.doctor.finding import Finding, Verdict
from greywhale.board.limits import DOCTOR
from greywhale.board.pots import POTS
from greywhale.board.refusal import pot_name, upper_first
from greywhale.protocol.firmware import TICK_S


@dataclass(frozen=True)
class Quiet:
    """A potentiometer at rest: its noise (rms), hum (amplitude at `hum_hz`), jumps, and its mean's range."""

    noise_counts: float
    hum_counts: float
    hum_hz: float
    jumps: int
    wandered_counts: float


def look(counts: Floats) -> Quiet:
    """Measure one potentiometer (rows,) of at least half a second."""
    median = scipy.ndimage.median_filter(counts, DOCTOR.median_ticks, mode="nearest")
    away = counts - median
    usual = 1.4826 * float(np.median(np.abs(away - np.median(away))))
    jumped = np.abs(away) > max(DOCTOR.jump_counts, DOCTOR.jump_noise_ratio * usual)
    settled = np.where(jumped, median, counts)
    mean = scipy.ndimage.uniform_filter1d(settled, DOCTOR.mean_ticks, mode="nearest")
    rest = settled - mean
    humming = [_hum(rest, hertz) for hertz in DOCTOR.hum_hz]
    loudest = int(np.argmax(humming))
    return Quiet(
        noise_counts=float(np.sqrt(np.mean(rest**2))),
        hum_counts=humming[loudest],
        hum_hz=DOCTOR.hum_hz[loudest],
        jumps=int(np.count_nonzero(np.diff(jumped.astype(np.int8)) == 1)),
        wandered_counts=float(np.ptp(mean)),
    )


def examine_pots(counts: Floats, rails: list[str]) -> list[Finding]:
    """Findings about counts (rows, 8), leader 0..3, follower 0..3; `rails` are the sentences about pots at a rail."""
    findings = [Finding("rails", Verdict.BAD, upper_first(sentence)) for sentence in rails]
    if not rails:
        findings.append(Finding("rails", Verdict.GOOD, "No potentiometer reads at a rail."))
    quiet = [look(counts[:, pot]) for pot in range(len(POTS))]
    moved = [pot for pot, one in enumerate(quiet) if one.wandered_counts > DOCTOR.moved_counts and not one.jumps]
    if moved:
        findings.append(
            Finding(
                "at rest",
                Verdict.NOTE,
                f"{_names(moved)} moved by up to {max(quiet[pot].wandered_counts for pot in moved):.0f} counts "
                "meanwhile.",
                "Keep both arms still and look again; if nobody touched them, look for a slipping or loose one.",
            )
        )
    return [*findings, _alike(counts), _jumps(quiet), _noise(quiet), _hums(quiet)]


def _alike(counts: Floats) -> Finding:
    rest = counts - scipy.ndimage.uniform_filter1d(counts, DOCTOR.mean_ticks, axis=0, mode="nearest")
    spread = np.sqrt(np.mean(rest**2, axis=0)) + 1e-9
    together = (rest.T @ rest) / len(rest) / np.outer(spread, spread)
    mean = counts.mean(axis=0)
    pairs = [
        (one, other)
        for one in range(len(POTS))
        for other in range(one + 1, len(POTS))
        if together[one, other] > DOCTOR.alike_correlation and abs(mean[one] - mean[other]) < DOCTOR.alike_counts
    ]
    if not pairs:
        return Finding("inputs", Verdict.GOOD, "Each reads something of its own.")
    listed = "; ".join(f"{pot_name(one)} and {pot_name(other)}" for one, other in pairs)
    return Finding(
        "inputs",
        Verdict.BAD,
        f"These read alike: {listed}.",
        "One of them is not connected (its input keeps the other's charge), or both wires are on one potentiometer: "
        "check the wipers' wires, and put 100 kOhm from each input to ground.",
    )


def _jumps(quiet: list[Quiet]) -> Finding:
    jumping = [pot for pot, one in enumerate(quiet) if one.jumps]
    if not jumping:
        return Finding("contacts", Verdict.GOOD, "Nothing jumped.")
    listed = ", ".join(f"{pot_name(pot)} {quiet[pot].jumps} times" for pot in jumping)
    return Finding(
        "contacts",
        Verdict.BAD,
        f"Readings jumped: {listed}.",
        "A wire or wiper is loose there: check its three wires, solder instead of clamping, replace a worn track.",
    )


def _noise(quiet: list[Quiet]) -> Finding:
    noise = np.array([one.noise_counts for one in quiet])
    loud = [pot for pot in range(len(POTS)) if noise[pot] > DOCTOR.much_noise_counts]
    if not loud:
        return Finding("noise", Verdict.GOOD, f"At most {noise.max():.1f} counts rms.")
    listed = ", ".join(f"{pot_name(pot)} {noise[pot]:.1f}" for pot in loud)
    return Finding(
        "noise",
        Verdict.BAD if noise.max() > DOCTOR.most_noise_counts else Verdict.NOTE,
        f"Noisy, in counts rms: {listed}.",
        "Put 100 nF from wiper to ground at the board's pin, keep motor wires away, feed the potentiometers from 5V.",
    )


def _hums(quiet: list[Quiet]) -> Finding:
    humming = [pot for pot, one in enumerate(quiet) if one.hum_counts > DOCTOR.much_hum_counts]
    if not humming:
        return Finding("hum", Verdict.GOOD, f"At most {max(one.hum_counts for one in quiet):.1f} counts of mains hum.")
    listed = ", ".join(
        f"{pot_name(pot)} {quiet[pot].hum_counts:.1f} counts at {quiet[pot].hum_hz:g} Hz" for pot in humming
    )
    return Finding(
        "hum",
        Verdict.NOTE,
        f"Mains hum: {listed}.",
        "Join the grounds of supply, board and computer at one point, and twist each wiper's wire with its ground.",
    )


def _hum(rest: Floats, hertz: float) -> float:
    """The amplitude at a frequency and at twice of it, together."""
    time_s = TICK_S * np.arange(len(rest))
    powers = [abs(2.0 * np.mean(rest * np.exp(-2j * np.pi * part * hertz * time_s))) ** 2 for part in (1, 2)]
    return float(np.sqrt(sum(powers)))


def _names(pots: list[int]) -> str:
    names = [pot_name(pot) for pot in pots]
    text = names[0] if len(names) == 1 else ", ".join(names[:-1]) + " and " + names[-1]
    return upper_first(text)
