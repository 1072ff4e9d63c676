"""`python -m greywhale_sim`: a bench behind a serial port; the first line printed is the port."""

import sys

if __name__ == "__main__" and not sys.flags.safe_path:
    del sys.path[0]  # `python -m` looks in the current folder first, and would run a `json.py` that lies there

import json

import click

from greywhale.base.errors import UserError
from greywhale_sim.faults import listed
from greywhale_sim.serve import serve
from greywhale_sim.words import read


def main() -> int:
    try:
        options, as_json = read(sys.argv[1:])
    except click.ClickException as error:
        error.show()
        return error.exit_code
    except click.exceptions.Exit as end:  # after --help
        return end.exit_code
    if "list" in options.faults:
        print(listed())
        return 0

    def ready(port: str) -> None:
        print(json.dumps({"port": port}) if as_json else port, flush=True)

    def note(text: str) -> None:
        print(f"greywhale_sim: {text}", file=sys.stderr, flush=True)

    try:
        serve(options, ready, note=note)
    except UserError as error:
        print(f"greywhale_sim: {error.message}", file=sys.stderr)
        return error.exit_code
    except KeyboardInterrupt:  # before the bench was up
        return 130
    return 0


if __name__ == "__main__":
    sys.exit(main())
