"""`greywhale` and `python -m greywhale`: makes the start safe and short, before anything else is imported."""

import sys

if __name__ == "__main__" and not sys.flags.safe_path:
    del sys.path[0]  # `python -m` looks in the current folder first, and would run a `signal.py` that lies there

import os
import signal

# To start threads for linear algebra takes longer than all the linear algebra of most verbs.
os.environ.setdefault("OPENBLAS_NUM_THREADS", "1")

# Until the verbs are there, Ctrl-C ends this process without a traceback of what was being imported.
if signal.getsignal(signal.SIGINT) is signal.default_int_handler:
    signal.signal(signal.SIGINT, signal.SIG_DFL)


def main() -> None:
    """Run the command line and exit."""
    from greywhale.cli import entry

    entry.main()


if __name__ == "__main__":
    main()
