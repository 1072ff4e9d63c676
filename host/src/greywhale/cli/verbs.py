"""The verbs and where they live. A verb's module is imported only when it runs, so that --help stays quick."""

from __future__ import annotations

import keyword
import pkgutil
from pathlib import Path

import click

from greywhale.base.errors import UserError
from greywhale.cli import foreign, tracing
from greywhale.cli.group import Group
from greywhale.cli.output import FILE, QUIET, option

# Each verb that has a module in this folder, and what it does.
VERBS = {
    "demo": "The whole story on the simulated bench in one go, pictures at the end.",
    "sim": "Start the simulated bench and print its serial port.",
    "dashboard": "The arm live in the browser: what it does, its controllers, every verb.",
    "ports": "List the serial ports and what is behind them.",
    "flash": "Put the firmware onto a board.",
    "info": "Tell a board's version, state, faults and counters.",
    "doctor": "Say what is wrong with this set-up, and how to mend it.",
    "calibrate": "From potentiometers mounted anyhow to angles, directions and limits.",
    "calibrations": "The calibrations that a board has had, and the way back to one.",
    "udev": "Print the rules that let this user open an Arduino's port.",
    "upload": "Run and store the controllers of a controller.toml.",
    "params": "Read and change a board's parameter table.",
    "record": "Record leader, follower and voltages into a CSV log.",
    "replay": "Lead the arm along a motion from a file and record it.",
    "stop": "Stop the motors; clear a fault.",
    "clutch": "Move the leader without the follower: disengage, engage, reset.",
    "evaluate": "Measure how well the follower followed in a log.",
    "commission": "Identify, tune and prove the controllers on the connected arm itself.",
    "adapt": "Keep the controllers right while a person works with the arm.",
    "identify": "Find the arm that made a log: a model with its uncertainties.",
    "tune": "Find controllers for a model: a controller.toml for upload.",
    "arm": "Make an arm.toml: from a ruler, a scale and data sheets, or from a URDF.",
    "export": "Write logs, controllers and arms in formats of other programs.",
    "import": "Make a log of another program's recording.",
    "fis": "Tell what a .fis holds, and take its sets into a controller.",
}


def all_verbs() -> dict[str, str]:
    """These verbs and those of other distributions, each with what it does. No other takes the name of one of these."""
    others = {name: foreign.does(entry) for name, entry in foreign.find().items() if name not in VERBS}
    return VERBS | others


def place_of(verb: str) -> str:
    """The place of a verb's click command: module:name."""
    return _place(verb) if verb in VERBS else foreign.place_of(foreign.find()[verb])


def _place(verb: str) -> str:
    return f"{__package__}.{verb}{'_' * keyword.iskeyword(verb)}:command"


class Verbs(Group):
    """A group whose commands are imported on demand."""

    def list_commands(self, ctx: click.Context) -> list[str]:
        return list(VERBS | foreign.find())

    def get_command(self, ctx: click.Context, cmd_name: str) -> click.Command | None:
        if cmd_name in VERBS:
            command = pkgutil.resolve_name(_place(cmd_name))
            assert isinstance(command, click.Command)
            return command
        try:
            return foreign.command_of(cmd_name)
        except UserError:
            if ctx.resilient_parsing:  # the completion of a shell, which has no place for a sentence
                return None
            raise

    def format_commands(self, ctx: click.Context, formatter: click.HelpFormatter) -> None:
        with formatter.section("Verbs"):
            formatter.write_dl(list(all_verbs().items()))


@click.group(cls=Verbs, context_settings={"help_option_names": ["-h", "--help"], "max_content_width": 100})
@click.version_option(package_name="greywhale", prog_name="greywhale")
@option("--verbose", "-v", count=True, help="Tell on stderr what is being done; -vv: every request too.")
@option("--quiet", "-q", is_flag=True, help="Show no progress; errors, warnings and results stay.")
@option("--log-file", type=FILE, metavar="FILE", help="Append all of that to a file, for a bug report.")
@click.pass_context
def greywhale(context: click.Context, verbose: int, quiet: bool, log_file: Path | None) -> None:
    """Identify, tune and run leader-follower robot arms. Every verb has --help and --json;
    params and arm have verbs of their own, which have them.

    Exit codes: 0 done, 1 failed, 2 bad usage, 130 interrupted (motors off, files whole).
    """
    context.meta[QUIET] = quiet
    tracing.begin(verbose, log_file)
    tracing.tell_command(context.obj or ())
