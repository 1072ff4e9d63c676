"""The generator: committed files are current, stale ones are noticed, contradicting declarations are refused."""

from __future__ import annotations

import shutil
from collections.abc import Callable
from pathlib import Path
from typing import NamedTuple

import pytest

from tools import ROOT
from tools.generate.link.__main__ import main

GENERATED = [
    "firmware/lib/link/src/link/schema.h",
    "firmware/lib/codes/src/codes/codes.h",
    "firmware/lib/params/src/params/table.h",
    "firmware/lib/params/src/params/table.cpp",
    "firmware/test/native/messages.h",
    "host/src/greywhale/protocol/schema.py",
    "host/web/src/link/schema.ts",
    "shared/link/golden.toml",
    "docs/link.md",
]


class Done(NamedTuple):
    """The end of `python -m tools.generate.link`."""

    code: int
    out: list[str]
    err: list[str]


@pytest.fixture
def generate(capsys: pytest.CaptureFixture[str]) -> Callable[..., Done]:
    def run(*words: str | Path) -> Done:
        code = main([str(word) for word in words])
        said = capsys.readouterr()
        return Done(code, said.out.splitlines(), said.err.splitlines())

    return run


@pytest.fixture
def copy(tmp_path: Path) -> Path:
    """A root with the declarations and everything generated from them."""
    shutil.copytree(ROOT / "shared/link", tmp_path / "shared/link")
    for path in GENERATED:
        (tmp_path / path).parent.mkdir(parents=True, exist_ok=True)
        shutil.copy(ROOT / path, tmp_path / path)
    return tmp_path


def edit(path: Path, old: str, new: str) -> None:
    text = path.read_text(encoding="utf-8")
    assert old in text
    path.write_text(text.replace(old, new, 1), encoding="utf-8")


def test_committed_files_are_current(generate: Callable[..., Done]) -> None:
    assert generate("--check") == (0, [], [])


def test_each_stale_or_missing_file_is_named(copy: Path, generate: Callable[..., Done]) -> None:
    *stale, missing = GENERATED
    for path in stale:
        with (copy / path).open("a", encoding="utf-8") as file:
            file.write("edited\n")
    (copy / missing).unlink()
    code, _, told = generate("--check", "--root", copy)
    assert code == 1
    assert sorted(told) == sorted(
        f"{path} does not match shared/link; run `python -m tools.generate.link`." for path in GENERATED
    )
    assert sorted(generate("--root", copy).out) == sorted(f"wrote {path}" for path in GENERATED)
    assert all((copy / path).read_bytes() == (ROOT / path).read_bytes() for path in GENERATED)


def test_a_changed_description_leaves_the_schema_hash_alone(copy: Path, generate: Callable[..., Done]) -> None:
    edit(copy / "shared/link/messages.toml", "Motors off. Works in every state.", "Motors off, always.")
    generate("--root", copy)
    line = next(line for line in (ROOT / GENERATED[0]).read_text().splitlines() if "schema_hash" in line)
    text = (copy / GENERATED[0]).read_text()
    assert line in text
    assert "Motors off, always." in text


@pytest.mark.parametrize(
    ("file", "old", "new", "sentence"),
    [
        ("messages.toml", 'type = "u32", unit = "ticks"', 'type = "u24", unit = "ticks"', "tick has the type u24"),
        ("messages.toml", "type = 0x0C", "type = 0x0B", "share a name or a type"),
        ("messages.toml", "max_payload = 48", "max_payload = 20", "more than max_payload"),
        ("messages.toml", 'enum = "Board"', 'enum = "Bord"', "names the enum Bord"),
        ("messages.toml", "protocol = 1", "protokoll = 1", "lacks the key 'protocol'"),
        ("enums.toml", 'name = "disabled", value = 1', 'name = "disabled", value = 0', "State repeats a value"),
        ("parameters.toml", "min = 3000, max = 30000", "min = 3000, max = 70000", "supply_mv does not fit its type"),
        ("parameters.toml", '"0.630", "0.782"]', '"0.630"]', "kp does not fit its type"),
        ("parameters.toml", 'below = "limit_max"', 'below = "limit"', "limit_min is below limit, which"),
        ("parameters.toml", '"rail_counts", type = "u8"', '"rail_counts", type = "u16"', "layout_hash = 0x"),
    ],
)
def test_a_declaration_that_cannot_be_is_refused(
    copy: Path, generate: Callable[..., Done], file: str, old: str, new: str, sentence: str
) -> None:
    edit(copy / "shared/link" / file, old, new)
    code, wrote, told = generate("--root", copy)
    assert (code, wrote) == (1, [])
    assert sentence in told[0]
