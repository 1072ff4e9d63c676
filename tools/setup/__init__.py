"""Everything that make needs, from a bare system on. An older Python reads what follows, too, and says so."""

import sys

if sys.version_info < (3, 11):  # noqa: UP036 (an older Python is what this is about)
    sys.exit(f"greywhale needs Python 3.11 or newer, but {sys.executable} is {sys.version.split()[0]}.")
