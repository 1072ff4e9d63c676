"""Looks at how a room uses its limits: which it reads in its code, and whether a run reads the ones it was handed."""

from __future__ import annotations

import ast
import re
from collections.abc import Iterator
from contextlib import contextmanager
from dataclasses import fields, is_dataclass, replace
from pathlib import Path
from typing import Any

import pytest


def attributes_read(folder: Path) -> set[str]:
    """The names of all attributes that a room's code reads; its limits.py reads only those of shared groups."""
    return {
        node.attr
        for path in folder.rglob("*.py")
        for node in ast.walk(ast.parse(path.read_text(encoding="utf-8")))
        if isinstance(node, ast.Attribute)
    }


def groups_of(limits: Any) -> Iterator[Any]:
    """A dataclass of limits, and all groups in it."""
    yield limits
    for one in fields(limits):
        value = getattr(limits, one.name)
        if is_dataclass(value):
            yield from groups_of(value)


def copy_of(limits: Any) -> Any:
    """Equal limits, none of whose groups is the same object."""
    groups = {one.name: getattr(limits, one.name) for one in fields(limits)}
    return replace(limits, **{name: copy_of(value) for name, value in groups.items() if is_dataclass(value)})


def members_read(folder: Path) -> set[str]:
    """The names of all members that compiled code reads; what is generated there only declares them."""
    return {name for path in folder.glob("*.cpp") for name in re.findall(r"\.(\w+)", path.read_text(encoding="utf-8"))}


@contextmanager
def reads_of(usual: Any) -> Iterator[set[str]]:
    """The limits that are read from the usual ones meanwhile: a run with a copy of them reads none."""
    found: set[str] = set()
    own = {id(one) for one in groups_of(usual)}

    def look(self: Any, name: str) -> Any:
        if id(self) in own and not name.startswith("__"):
            found.add(f"{object.__getattribute__(self, '__class__').__name__}.{name}")
        return object.__getattribute__(self, name)

    with pytest.MonkeyPatch.context() as patch:
        for kind in {type(one) for one in groups_of(usual)}:
            patch.setattr(kind, "__getattribute__", look, raising=False)
        yield found
