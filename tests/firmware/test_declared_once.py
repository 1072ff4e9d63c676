"""The firmware does not compile when shared/link declares a request that it does not handle."""

from __future__ import annotations

import os
import subprocess
from dataclasses import replace
from pathlib import Path

from tools import ROOT
from tools.generate.link import cpp_messages
from tools.generate.link.declaration import Declaration, load

DECLARED = load(ROOT / "shared/link")


def errors(folder: Path, declaration: Declaration) -> str:
    """What the compiler says of the firmware's requests when shared/link declares this."""
    (folder / "link").mkdir()
    (folder / "link/schema.h").write_text(cpp_messages.header(declaration), encoding="utf-8")
    rooms = sorted((ROOT / "firmware/lib").glob("*/src"))
    done = subprocess.run(
        ["g++", "-std=gnu++14", "-fsyntax-only", "-Wall", "-Wextra", "-Wconversion", "-Werror", f"-I{folder}"]
        + [f"-I{room}" for room in rooms]
        + [ROOT / "firmware/lib/app/src/link_server.cpp"],
        capture_output=True,
        text=True,
        check=False,
        env={**os.environ, "LC_ALL": "C"},
    )
    assert (done.returncode == 0) == (done.stderr == "")
    return done.stderr


def test_what_is_declared_today_compiles(tmp_path: Path) -> None:
    assert errors(tmp_path, DECLARED) == ""


def test_a_request_without_a_case_is_named(tmp_path: Path) -> None:
    stop = next(message for message in DECLARED.messages if message.struct == "StopRequest")
    park = replace(stop, name="park", struct="ParkRequest", type=0x10)
    found = errors(tmp_path, replace(DECLARED, messages=(*DECLARED.messages, park)))
    assert "'park' not handled in switch" in found
