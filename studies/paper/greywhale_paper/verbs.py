"""The verbs that this distribution brings: its entry points lead here, and `greywhale --help` reads them."""

from __future__ import annotations

from greywhale.cli.foreign import Verb

REPRODUCE = Verb(
    does="The paper from end to end: every table and figure beside ours.",
    command="greywhale_paper.cli.reproduce:command",
)
COMPARE = Verb(
    does="Compare optimisers at equal budgets, over many seeds.",
    command="greywhale_paper.cli.compare:command",
)
