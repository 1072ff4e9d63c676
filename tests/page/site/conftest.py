"""The page with a bench inside, built once for all of its tests."""

from __future__ import annotations

from collections.abc import Iterator
from pathlib import Path

import pytest

from tests.page.site.serve_folder import Site, serve
from tools.site.build import build


@pytest.fixture(scope="session")
def folder(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """The page with a bench inside, built."""
    made: Path = tmp_path_factory.mktemp("site")
    build(made)
    return made


@pytest.fixture
def site(folder: Path) -> Iterator[Site]:
    with serve(folder) as served:
        yield served
