"""Whoever adds parameters by the recipe of docs/extending.md finds room for them: for as many as the store takes."""

from __future__ import annotations

import re
import shutil
import subprocess
import tomllib
from binascii import crc_hqx
from collections.abc import Sequence
from dataclasses import replace
from pathlib import Path

import pytest

from greywhale.protocol.declared import CRC_START
from greywhale.protocol.schema import DEFAULTS, pack_parameters
from tools import ROOT
from tools.gates import apply, size, stack, tick
from tools.gates.timing.image import TARGETS, Target, times
from tools.gates.timing.listing import read_program
from tools.generate.link.__main__ import main as generate
from tools.generate.link.declaration import MAX_TABLE_BYTES, DeclarationError, load
from tools.setup import platformio, venv

pytestmark = pytest.mark.slow
NANO = next(target for target in TARGETS if target.environment == "nanoatmega328")
PARAMETER = '{{ name = "more_{number}", type = "u16", unit = "", min = 0, max = 1, default = 0, description = "" }}'
GROUP = """
[[group]]
name = "joint"
member = "more"
struct = "MoreParameters"
since = {layout}
description = "What a stranger adds."
count = 4
parameters = [{parameters}]
"""
# Of another compiler's image facts.toml says nothing: the system's may be any.
DESCRIBED = [NANO] if NANO.is_described() else []
NUMBER_BYTES = 4 * 2  # of a parameter of two bytes for each joint
NUMBERS = (MAX_TABLE_BYTES - len(pack_parameters(DEFAULTS))) // NUMBER_BYTES


@pytest.fixture(scope="module")
def nano(tmp_path_factory: pytest.TempPathFactory) -> Target:
    """The Nano's image with the parameters, generated and built in a copy of the repository."""
    copy = tmp_path_factory.mktemp("copy")
    shutil.copytree(ROOT / "shared", copy / "shared")
    shutil.copytree(ROOT / "firmware", copy / "firmware", ignore=shutil.ignore_patterns(".pio", "test"))
    declare(copy / "shared/link/parameters.toml")
    assert generate(["--root", str(copy)]) == 0
    built = copy / "build"
    command = [
        str(venv.PYTHON),
        "-m",
        "platformio",
        "run",
        "--project-dir",
        str(copy / "firmware"),
        "-e",
        NANO.environment,
    ]
    surroundings = {**platformio.full_environment(), "PLATFORMIO_BUILD_DIR": str(built)}
    subprocess.run(command, env=surroundings, check=True, capture_output=True)
    return replace(NANO, built=built)


def declare(file: Path) -> None:
    """Adds the group; the generator refuses once, and names the hash of the new layout."""
    text = file.read_text()
    layout = int(tomllib.loads(text)["layout"]) + 1
    parameters = ",".join(PARAMETER.format(number=number) for number in range(NUMBERS))
    text = re.sub(r"^layout = \d+$", f"layout = {layout}", text, flags=re.MULTILINE)
    text += GROUP.format(layout=layout, parameters=parameters)
    file.write_text(text)
    with pytest.raises(DeclarationError) as refused:
        load(file.parent)
    hash_line = str(refused.value)[-len("layout_hash = 0x01234567.") : -1]
    file.write_text(re.sub(r"^layout_hash = \w+$", hash_line, text, flags=re.MULTILINE))


def crc(values: Sequence[int]) -> int:
    """Of the longer table: what is new has its default, 0."""
    return crc_hqx(pack_parameters(values) + bytes(NUMBERS * NUMBER_BYTES), CRC_START)


def test_there_is_room_for_a_parameter_of_each_joint_at_least() -> None:
    assert NUMBERS >= 1


def test_more_parameters_fit_the_nano_beside_its_stack(nano: Target) -> None:
    assert size.taken(nano.elf)[1] == size.taken(NANO.elf)[1] + 2 * NUMBERS * NUMBER_BYTES
    assert size.complaints(nano.elf) == []
    deepest = stack.bound(nano.elf, nano.chip)
    assert deepest.bytes <= deepest.free


def test_more_parameters_bring_nothing_slow_into_a_tick(nano: Target) -> None:
    assert tick.complaints(read_program(nano.elf)) == []


@pytest.mark.parametrize("own", DESCRIBED, ids=lambda target: target.title)
def test_more_parameters_cost_a_tick_no_more_than_other_addresses_may(nano: Target, own: Target) -> None:
    assert times(nano).tick <= 1.01 * times(own).tick


def test_a_set_with_more_parameters_is_applied_and_makes_no_tick_late(nano: Target) -> None:
    assert apply.complaints(apply.apply_sets(nano, crc)) == []
