"""Where other controllers make a joint overshoot more, which a lower error hides."""

from __future__ import annotations

from greywhale.motion.evaluate import Evaluation

# More than this, in per cent of the step, is no chance.
MORE_PERCENT = 5.0


def more_overshoot(before: Evaluation, after: Evaluation) -> str:
    """The joints in use that overshoot clearly more than before, such as "joint 2 from 4 to 31 %"; "" for none."""
    said = []
    for joint in before.joints_in_use:
        was, now = before.joints[joint].overshoot_percent, after.joints[joint].overshoot_percent
        if was is not None and now is not None and now > was + MORE_PERCENT:
            said.append(f"joint {joint} from {was:.0f} to {now:.0f} %")
    return ", ".join(said)
