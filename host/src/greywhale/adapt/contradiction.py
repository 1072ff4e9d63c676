"""Compares how far a joint's potentiometer turns with what its voltages say, from the fit to the last stretches.

A reading that turns too little makes a speed and an acceleration cost more volts by the same factor, and leaves
friction as it was. An arm that works does not change like that: a hot motor and a sagging supply make friction cost as
much more, grease changes what a speed costs, a load what an acceleration costs.
"""

from __future__ import annotations

from collections.abc import Mapping

from greywhale.protocol.joints import Joints


def find_contradiction(changes: Mapping[str, float], joints: Joints, max_pot_error: float) -> str:
    """A clause on the first joint whose reading contradicts its voltages, "" for none.

    `changes` are those of `LiveModel.changes`: what each number has become, as a multiple of the identified one. A
    potentiometer that turns too little, or too far, by more than `max_pot_error` is doubted.
    """
    for joint in joints:
        inertia, damping, friction = (
            changes.get(f"joint{joint}.{kind}", 1.0) for kind in ("inertia", "damping", "coulomb")
        )
        too_little = min(inertia, damping) / max(1.0, friction)
        too_far = min(1.0, friction) / max(inertia, damping)
        if max(too_little, too_far) > max_pot_error:
            return (
                f"joint {joint}'s potentiometer turns {1.0 / damping:.1f} times as far as its motor's voltages say, "
                "so nothing is kept; check that it is tight on its shaft"
            )
    return ""
