"""A room of which the ablation screens the numbers, and the arms on which it does."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import astuple, dataclass, field, replace
from typing import Any

from greywhale.arm import ArmParameters
from greywhale.base.limits import BY_DEFINITION, Limit, limits_in
from greywhale.files.arm import default_arm
from tools import ROOT
from tools.benchmarks.bench_commission import traits_of
from tools.support.foreign_arm import foreign_arm_with
from tools.support.recordings import worn_arm

FOLDER = ROOT / "build" / "ablation"
FACTORS = (0.5, 2.0)
RATIO = 1.5  # a factor below this is one beyond 1, and 1 does nothing


@dataclass(frozen=True)
class Ablated:
    """The usual limits, the groups whose plain numbers are screened but for those apart, and what a run measures.

    `closer` has levels nearer than half and twice, `off` what switches a rule off. `measure` is called with a seed, an
    arm's kind and number, values of limits and the options; all that it returns is better the smaller it is. `prepare`
    is called once for each arm before.
    """

    limits: Any
    groups: tuple[str, ...]
    apart: tuple[str, ...]
    closer: Mapping[str, tuple[Any, Any]]
    off: Mapping[str, Any]
    measure: Callable[..., dict[str, float]]
    options: Mapping[str, Any] = field(default_factory=dict)
    prepare: Callable[[str, int], object] = lambda kind, number: None

    def numbers(self) -> dict[str, tuple[Any, Any]]:
        """By name: the lower and the upper value of every number that is screened."""
        found = {one.name: _levels_of(one) for one in limits_in(self.limits) if self._is_screened(one)}
        return found | dict(self.closer)

    def _is_screened(self, one: Limit) -> bool:
        number = isinstance(one.value, int | float) and one.origin != BY_DEFINITION
        return number and one.name.split(".")[0] in self.groups and one.name not in self.apart

    def rules(self) -> dict[str, tuple[Any, Any]]:
        """By name: the value that switches a rule off, and the usual one."""
        return {name: (off, _usual(self.limits, name)) for name, off in self.off.items()}


def _levels_of(one: Limit) -> tuple[Any, Any]:
    """Half and twice the value, of what it is beyond 1 where it is a factor; a share comes only half as near to 1."""
    lower, upper = (factor * one.value for factor in FACTORS)
    if isinstance(one.value, int):
        return max(1, round(lower)), round(upper)
    if one.unit.startswith("times") and 1.0 < one.value < RATIO:
        lower, upper = (1.0 + factor * (one.value - 1.0) for factor in FACTORS)
    elif one.name.endswith("_share") and upper >= 1.0:
        upper = 1.0 - 0.5 * (1.0 - one.value)
    return lower, upper


def _usual(limits: Any, name: str) -> Any:
    """The value of a limit by its dotted name."""
    group, inner = name.split(".")
    return getattr(getattr(limits, group), inner)


def with_values(limits: Any, values: Mapping[str, Any]) -> Any:
    """The limits with others by their dotted names."""
    for name, value in values.items():
        group, inner = name.split(".")
        limits = replace(limits, **{group: replace(getattr(limits, group), **{inner: value})})
    return limits


def true_arm(kind: str, seed: int) -> ArmParameters:
    """The arm that was recorded; MuJoCo's without what our engine does not have."""
    if kind == "default":
        return default_arm()
    if kind == "worn":
        return worn_arm(seed)
    foreign = foreign_arm_with(seed, traits_of(kind))
    data = foreign.parameters.model_dump()
    for pot, play in zip(data["follower_pots"]["joint"], foreign.play, strict=True):
        pot["play"] = 0.5 * float(play)
    if foreign.gears is not None:
        for joint, *teeth in zip(data["joint"], *astuple(foreign.gears), strict=True):
            joint["gear"] = dict(zip(("half_gap", "stiffness", "damping"), map(float, teeth), strict=True))
    return ArmParameters.model_validate(data, strict=False)
