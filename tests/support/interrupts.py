"""A person who presses Ctrl-C at a step of a long computation."""

from __future__ import annotations

from collections.abc import Callable


def ctrl_c_at(step: str, beyond: float = -1.0) -> Callable[..., None]:
    """Progress whose reader presses Ctrl-C when the step with these words has come beyond this share."""

    def report(what: str, fraction: float, note: str = "") -> None:
        if step in what and fraction > beyond:
            raise KeyboardInterrupt

    return report
