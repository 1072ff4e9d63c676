"""greywhale: open firmware and tuner for leader-follower robot arms read by potentiometers and moved by DC motors."""

from __future__ import annotations

from typing import TYPE_CHECKING

if TYPE_CHECKING:
    __version__: str
else:

    def __getattr__(name: str) -> str:
        """Look `__version__` up when it is asked for: verbs start sooner, and a source tree needs no installation."""
        if name != "__version__":
            raise AttributeError(f"module {__name__!r} has no attribute {name!r}")
        from importlib.metadata import version

        return version("greywhale")
