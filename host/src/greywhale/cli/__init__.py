"""The command line: `greywhale VERB`. One module a verb; `main` turns every failure into a sentence and an exit
code.
"""

from greywhale.cli.entry import main

__all__ = ["main"]
