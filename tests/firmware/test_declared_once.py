"""The firmware does not compile when it differs from shared/link: a request without a handler, an enum that differs."""

from __future__ import annotations

import os
import subprocess
from dataclasses import replace
from pathlib import Path

import pytest

from tools import ROOT
from tools.generate.link import cpp_enum_copies, cpp_messages
from tools.generate.link.declaration import Declaration, Enum, EnumValue, load

DECLARED = load(ROOT / "shared/link")
COPIED = ["State", "StopReason", "Fault", "ResetCause", "Board", "Refusal"]  # by rooms that do not know the link


def errors(folder: Path, declaration: Declaration) -> str:
    """What the compiler says of the firmware's requests when shared/link declares this."""
    (folder / "link").mkdir()
    (folder / "link/schema.h").write_text(cpp_messages.header(declaration), encoding="utf-8")
    (folder / "link/enum_copies.h").write_text(cpp_enum_copies.header(declaration), encoding="utf-8")
    rooms = sorted((ROOT / "firmware/lib").glob("*/src"))
    done = subprocess.run(
        ["g++", "-std=gnu++14", "-fsyntax-only", "-Wall", "-Wextra", "-Wconversion", "-Werror", f"-I{folder}"]
        + [f"-I{room}" for room in rooms]
        + [ROOT / "firmware/lib/app/src/requests.cpp"],
        capture_output=True,
        text=True,
        check=False,
        env={**os.environ, "LC_ALL": "C"},
    )
    assert (done.returncode == 0) == (done.stderr == "")
    return done.stderr


def with_values(name: str, values: tuple[EnumValue, ...]) -> Declaration:
    def changed(enum: Enum) -> Enum:
        return replace(enum, values=values) if enum.name == name else enum

    return replace(DECLARED, enums=tuple(changed(enum) for enum in DECLARED.enums))


def values_of(name: str) -> tuple[EnumValue, ...]:
    return next(enum.values for enum in DECLARED.enums if enum.name == name)


def test_what_is_declared_today_compiles(tmp_path: Path) -> None:
    assert errors(tmp_path, DECLARED) == ""


def test_a_request_without_a_case_is_named(tmp_path: Path) -> None:
    stop = next(message for message in DECLARED.messages if message.struct == "StopRequest")
    park = replace(stop, name="park", struct="ParkRequest", type=0x0F)
    found = errors(tmp_path, replace(DECLARED, messages=(*DECLARED.messages, park)))
    assert "'park' not handled in switch" in found


@pytest.mark.parametrize("name", COPIED)
def test_a_value_that_a_copy_lacks_is_named(tmp_path: Path, name: str) -> None:
    values = values_of(name)
    new = EnumValue("brand_new", len(values), "", "", "")
    assert "'brand_new' is not a member of" in errors(tmp_path, with_values(name, (*values, new)))


@pytest.mark.parametrize("name", COPIED)
def test_a_value_that_only_a_copy_has_is_named(tmp_path: Path, name: str) -> None:
    # The declaration loses its last value, so the copy has one more. Other code that needs the value fails too.
    *others, last = values_of(name)
    found = errors(tmp_path, with_values(name, tuple(others)))
    assert f"'{last.name}' not handled in switch" in found


@pytest.mark.parametrize("name", COPIED)
def test_every_number_that_differs_is_named(tmp_path: Path, name: str) -> None:
    moved = tuple(replace(value, value=value.value + 100) for value in values_of(name))
    found = errors(tmp_path, with_values(name, moved))
    for value in moved:
        assert f"{name}::{value.name}" in found
