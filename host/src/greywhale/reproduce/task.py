"""A piece of work: a function of a module, with its seed and plain arguments."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass, field
from typing import Any


@dataclass(frozen=True)
class Task:
    """`function(seed=seed, **arguments)` gives the result `key`."""

    key: str
    function: Callable[..., dict[str, Any]]
    seed: int
    arguments: Mapping[str, Any] = field(default_factory=dict)

    def run(self) -> dict[str, Any]:
        return self.function(seed=self.seed, **self.arguments)

    def facts(self) -> dict[str, Any]:
        """What the result depends on."""
        name = f"{self.function.__module__}.{self.function.__qualname__}"
        return {"key": self.key, "function": name, "seed": self.seed, "arguments": dict(self.arguments)}
