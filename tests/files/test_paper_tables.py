"""The paper's controllers are found and whole."""

import pytest

from greywhale.files import controller
from greywhale.files.paper_tables import paper_table


@pytest.mark.parametrize("name", ["before_tuning", "table_8", "table_9", "table_10"])
def test_every_table_is_a_controller(name: str) -> None:
    assert len(controller.load(paper_table(name)).joint) == 4
