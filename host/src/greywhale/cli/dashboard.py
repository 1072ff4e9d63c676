"""`greywhale dashboard`: the page, served to this machine alone."""

from __future__ import annotations

import contextlib
import json
import subprocess
import sys
import threading
import webbrowser
from collections.abc import Iterator, Mapping
from concurrent.futures import Future, ThreadPoolExecutor
from pathlib import Path
from typing import TYPE_CHECKING, Any, TypedDict

import click
from click.core import ParameterSource

from greywhale.base import bench_process, processes
from greywhale.base.errors import BadUsage
from greywhale.cli import completion
from greywhale.cli.bench import Mistakes, bench_options, show_mistakes, words_of
from greywhale.cli.output import FILE, json_of, json_option, option, port_option, tell
from greywhale.cli.person import on_enter
from greywhale.files.arm import load_arm

if TYPE_CHECKING:
    from greywhale.dashboard.access import Access


_PRACTICE = {"blank", "faults", "eeprom", "firmware"}  # parameters by which a board is not the bench's usual one


class DashboardAnswer(TypedDict):
    address: str  # to open in a browser, once
    token: str  # with which a program asks


@click.command("dashboard")
@option("--sim", is_flag=True, help="Start the simulated bench with it; the next six options belong to it.")
@bench_options
@option(
    "--arm",
    type=FILE,
    shell_complete=completion.arms,
    help="TOML with the arm that is drawn and predicted, and simulated with --sim; without it, the built-in one.",
)
@option(
    "--folder",
    type=click.Path(path_type=Path, file_okay=False, exists=True),
    default=".",
    help="Where the page's verbs read and write files; they reach no other folder.",
)
@option("--browser/--no-browser", default=True, help="Open the page in the browser.")
@option("--http-port", type=click.IntRange(0, 65535), default=0, help="Port of the page; 0 is any free one.")
@port_option
@json_option(DashboardAnswer | Mistakes)
@click.pass_context
def command(
    context: click.Context,
    /,
    sim: bool,
    arm: Path | None,
    folder: Path,
    browser: bool,
    http_port: int,
    port: str | None,
    as_json: bool,
    **of_bench: Any,
) -> None:
    """The arm live in the browser: what it does, its controllers, every verb.

    Prints the page's address, which opens it once, within ten minutes; Enter prints another one. Whoever opens it may
    drive the arm. Only this machine reaches it. A board may be plugged in later, and again. One page drives, others
    watch. The motors go off when the page that drives is closed or hangs. Ctrl-C ends the dashboard, motors off.
    """
    words = words_of(of_bench)
    for name, (flag, *_) in words.items():
        if not sim and _is_given(context, name):
            raise BadUsage(f"{flag} belongs to --sim; add that, or leave it out.")
    if sim and _is_given(context, "port"):
        raise BadUsage("--sim brings a board of its own; leave --port out, or --sim.")
    if "list" in of_bench["faults"]:
        show_mistakes(as_json)
        return
    if arm is not None:
        load_arm(arm)

    def ready(access: Access) -> None:
        answer: DashboardAnswer = {"address": access.address(), "token": access.token}
        click.echo(json_of(answer) if as_json else answer["address"])
        asks = not as_json and sys.stdin.isatty()
        tell(f"greywhale: the page is there; Ctrl-C here ends it, motors off{'; Enter prints another address' * asks}.")
        if asks:
            threading.Thread(target=on_enter, args=(lambda: click.echo(access.address()),), daemon=True).start()
        if browser:  # with an address of its own: the printed one may be opened elsewhere
            threading.Thread(target=webbrowser.open, args=(access.address(),), daemon=True).start()

    with contextlib.ExitStack() as held:
        starting = held.enter_context(_starting(words, arm)) if sim else None
        # It takes as long to import as a bench to start.
        from greywhale.dashboard import run

        bench = None if starting is None else starting.result()
        held_port = port if bench is None else bench.port
        follows = bench is not None and not words.keys() & _PRACTICE
        program = (sys.executable, "-m", "greywhale.cli.job")
        with contextlib.suppress(KeyboardInterrupt):  # the usual end
            run.serve(held_port, str(arm or "default"), folder, http_port, _catalogue, program, bench, follows, ready)


def _is_given(context: click.Context, name: str) -> bool:
    return context.get_parameter_source(name) is ParameterSource.COMMANDLINE


@contextlib.contextmanager
def _starting(options: Mapping[str, list[str]], arm: Path | None) -> Iterator[Future[bench_process.BenchProcess]]:
    """A bench that comes up meanwhile, and is ended whatever happens."""
    words = [word for one in options.values() for word in one] + ([] if arm is None else ["--arm", str(arm)])
    with ThreadPoolExecutor(1) as pool:
        starting = pool.submit(bench_process.BenchProcess, *words)
        try:
            yield starting
        finally:
            if starting.exception() is None:
                starting.result().close()


def _catalogue() -> Any:
    """The verbs that a page may start, from a process of its own: to import them all would hold the board up."""
    command = [sys.executable, "-m", "greywhale.cli.catalogue"]
    printed, _ = processes.start(command, stdout=subprocess.PIPE).communicate()
    return json.loads(printed)
