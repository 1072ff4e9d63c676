"""Base class of context managers with close(): a `with` closes them at its end."""

from __future__ import annotations

from abc import ABC, abstractmethod
from typing import Self


class Closing(ABC):
    """Use as a context."""

    @abstractmethod
    def close(self) -> None:
        """Give back what this holds; a second time does nothing."""

    def __enter__(self) -> Self:
        return self

    def __exit__(self, *error: object) -> None:
        self.close()
