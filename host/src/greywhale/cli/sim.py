"""`greywhale sim`: the simulated bench."""

from __future__ import annotations

import json
from pathlib import Path
from typing import Any, TypedDict

import click

from greywhale.cli.bench import Mistakes, bench_options, show_mistakes
from greywhale.cli.output import FILE, json_option, option, tell, warn
from greywhale.files.leader import load_leader
from greywhale.protocol.ports import lasting_name


class Port(TypedDict):
    port: str  # the bench's, as soon as it can be used


@click.command("sim")
@bench_options
@option("--leader", type=FILE, help="CSV with the leader's motion.")
@option("--arm", type=FILE, help="TOML with the arm; without it, the built-in one.")
@option("--speed", type=click.Choice(["1", "max"]), default="1", help="Real time or faster.")
@option("--listen", metavar="[HOST:]PORT", help="Be a TCP port instead of a serial one; 0 takes any free port.")
@option("--by-hand", is_flag=True, help="Be the person: type `turn leader 0`, `hold 30`; `help` lists all.")
@json_option(Port | Mistakes)
def command(leader: Path | None, faults: tuple[str, ...], by_hand: bool, as_json: bool, **options: Any) -> None:
    """Start the simulated bench and print its serial port; Ctrl-C ends it.

    On stderr it says the name under which `greywhale ports` lists the port.
    """
    if "list" in faults:
        show_mistakes(as_json)
        return
    from greywhale_sim import serve

    if leader is not None:
        warn(load_leader(leader).remarks)
    bench = serve.ServeOptions(leader=leader, faults=faults, by_hand=by_hand, **options)

    def ready(port: str) -> None:
        answer: Port = {"port": port}
        click.echo(json.dumps(answer) if as_json else port)
        tell(f"greywhale: {_hint(port)}")  # standard output is the port alone, for scripts
        if by_hand:
            tell("Your hands are words here, such as: turn leader 0, hold 30, hang. help lists all.")

    serve.serve(bench, on_ready=ready, note=lambda text: tell(f"greywhale: {text}"))


def _hint(port: str) -> str:
    """Advice on a person's next step, with the name of the port for all other commands."""
    name = lasting_name(port)
    if name == port:  # no other program finds it by itself
        return f"now, in a second terminal: greywhale info --port {port}. Ctrl-C here ends the bench."
    return (
        f"this bench is {name}; greywhale finds it by itself if there is no other board. "
        "Now, in a second terminal: greywhale info. Ctrl-C here ends the bench."
    )
