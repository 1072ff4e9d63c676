"""`greywhale flash`: the firmware onto a board, through its bootloader."""

from __future__ import annotations

from pathlib import Path

import click

from greywhale.base.telling import Step, told
from greywhale.base.types import Crc
from greywhale.board.flash import BOARDS, flash
from greywhale.board.greeting import version
from greywhale.cli.output import FILE, OnPort, json_option, option, port_option, progress, show
from greywhale.protocol.ports import choose_port


class FlashAnswer(OnPort):
    board: str  # mega2560 or nano328
    firmware: str  # version
    parameter_crc: Crc


@click.command("flash")
@option("--board", type=click.Choice(list(BOARDS)), help="The board; without it, the port or the bootloader tells.")
@option("--firmware", type=FILE, help="Folder of firmware source (with platformio.ini) to build.")
@option("--hex", "hex_file", type=FILE, help="Upload this HEX file.")
@port_option
@json_option(FlashAnswer)
def command(board: str | None, firmware: Path | None, hex_file: Path | None, port: str | None, as_json: bool) -> None:
    """Put the firmware onto a board.

    An installed greywhale writes the firmware that came with it; in a checkout, PlatformIO builds it first where its
    source has changed. A simulated board is flashed through its bootloader exactly as a real one. Afterwards the new
    firmware is greeted, so success means that it runs.
    """
    if firmware is not None and hex_file is not None:
        raise click.UsageError("--firmware and --hex exclude each other.")
    chosen = choose_port(port)
    with progress() as report:
        hello = flash(chosen, board, firmware, hex_file, report)
    answer: FlashAnswer = {
        "port": chosen,
        "board": hello.board.key,
        "firmware": version(hello),
        "parameter_crc": f"0x{hello.param_crc:04x}",
    }
    sentence = f"{chosen}: greywhale firmware {version(hello)} runs on the {hello.board.description}."
    show(as_json, answer, told(sentence, steps=[Step("doctor", "Look at the set-up")]))
