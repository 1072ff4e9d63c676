"""Files in `both`, which the page's tests read too: host and page take and refuse the same ones.

`told.json` has for each how the sentence begins behind the file's name; nothing for a file that is taken.
"""

from __future__ import annotations

import json
from collections.abc import Callable
from pathlib import Path

import pytest

from greywhale.base.errors import UserError
from greywhale.board.flash.images import read_image
from greywhale.files import controller, parameter_file
from tools.generate.files import main

BOTH = Path(__file__).with_name("both")
TOLD: dict[str, str] = json.loads((BOTH / "told.json").read_text("utf-8"))
READERS: dict[str, Callable[[Path], object]] = {
    "controller": controller.load,
    "parameters": parameter_file.load,
    "image": read_image,
}


def test_the_page_has_the_hosts_rules() -> None:
    """If not: `python -m tools.generate`."""
    assert main(["--check"]) == 0


def test_each_file_has_its_words() -> None:
    assert {path.name for path in BOTH.iterdir()} == {*TOLD, "told.json"}


@pytest.mark.parametrize("name", TOLD)
def test_it_is_taken_or_refused_in_these_words(name: str) -> None:
    path = BOTH / name
    read = READERS[path.stem.partition("-")[0]]
    if not TOLD[name]:
        read(path)
        return
    with pytest.raises(UserError) as caught:
        read(path)
    assert caught.value.message.startswith(f"{path}{TOLD[name]}")
