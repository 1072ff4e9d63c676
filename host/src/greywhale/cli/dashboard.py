"""`greywhale dashboard`: the page, served to this machine alone."""

from __future__ import annotations

import contextlib
import json
import secrets
import subprocess
import sys
import threading
import webbrowser
from pathlib import Path
from typing import Any, TypedDict

import click
from click.core import ParameterSource

from greywhale.base import bench_process, processes
from greywhale.base.errors import BAD_USAGE, UserError
from greywhale.cli import completion
from greywhale.cli.bench import need_bench
from greywhale.cli.output import json_of, json_option, port_option, tell
from greywhale.files.arm import load_arm


class Answer(TypedDict):
    address: str  # to open in a browser, with the token, as soon as it can be


@click.command("dashboard")
@click.option("--sim", is_flag=True, help="Start the simulated bench with it.")
@click.option("--board", type=click.Choice(["mega", "nano"]), default="mega", show_default=True, help="With --sim.")
@click.option(
    "--arm",
    type=click.Path(path_type=Path),
    shell_complete=completion.arms,
    help="TOML with the arm that is drawn and predicted, and simulated with --sim; without it, the built-in one.",
)
@click.option(
    "--folder",
    type=click.Path(path_type=Path, file_okay=False, exists=True),
    default=Path("."),
    show_default=True,
    help="Where the page's verbs read and write files; they reach no other folder.",
)
@click.option("--browser/--no-browser", default=True, show_default=True, help="Open the page in the browser.")
@click.option("--http-port", type=click.IntRange(0, 65535), default=0, help="Port of the page; 0 is any free one.")
@port_option
@json_option(Answer)
@click.pass_context
def command(
    context: click.Context,
    sim: bool,
    board: str,
    arm: Path | None,
    folder: Path,
    browser: bool,
    http_port: int,
    port: str | None,
    as_json: bool,
) -> None:
    """The arm live in the browser: what it does, its controllers, every verb.

    Prints the page's address, which holds a secret: whoever knows it drives the arm. Only this machine reaches it. A
    board may be plugged in later, and again. One page drives, others watch. The motors go off when the page that
    drives is closed or hangs. Ctrl-C ends the dashboard, motors off.
    """
    if sim and context.get_parameter_source("port") is ParameterSource.COMMANDLINE:
        raise UserError("--sim brings a board of its own; leave --port out, or --sim.", BAD_USAGE)
    if arm is not None:
        load_arm(arm)
    from greywhale.dashboard import server
    from greywhale.dashboard.bench import BenchControls
    from greywhale.dashboard.folder import Folder
    from greywhale.dashboard.history import History
    from greywhale.dashboard.house import House
    from greywhale.dashboard.jobs import Jobs
    from greywhale.dashboard.keeper import Keeper
    from greywhale.dashboard.relay import Relay

    page = server.require_page()
    with contextlib.ExitStack() as held:
        own_folder, bench = Folder(folder), None
        if sim:
            need_bench("greywhale_sim")
            process = held.enter_context(
                bench_process.BenchProcess("--board", board, *(["--arm", str(arm)] if arm else []))
            )
            port, bench = process.port, BenchControls(process, own_folder)
        relay = Relay(History())
        jobs = Jobs(relay, own_folder, _catalogue, [sys.executable, "-m", "greywhale.cli.job"])
        house = House(relay, own_folder, str(arm or "default"), jobs, bench)
        keeper = Keeper(house.relay, port)
        listener = held.enter_context(server.listen(http_port))
        number: int = listener.getsockname()[1]
        token = secrets.token_urlsafe(24)
        address = f"http://127.0.0.1:{number}/#token={token}"
        running = server.make_server(server.application(house, page, token, number))
        held.callback(keeper.close)
        held.callback(jobs.close)  # first, while their board is there
        keeper.start()
        answer: Answer = {"address": address}
        click.echo(json_of(answer) if as_json else address)
        tell("greywhale: the page is there; Ctrl-C here ends it, motors off.")
        if browser:
            threading.Thread(target=webbrowser.open, args=(address,), daemon=True).start()
        with contextlib.suppress(KeyboardInterrupt):  # the usual end
            running.run([listener])


def _catalogue() -> Any:
    """The verbs that a page may start, from a process of its own: to import them all would hold the board up."""
    command = [sys.executable, "-m", "greywhale.cli.catalogue"]
    printed, _ = processes.start(command, stdout=subprocess.PIPE).communicate()
    return json.loads(printed)
