"""The examination as a whole. The motors stay off; what cannot be looked at ends it with the finding that says why."""

from __future__ import annotations

from collections.abc import Iterator
from pathlib import Path

from greywhale.base.errors import UserError
from greywhale.base.types import Progress, show_no_progress
from greywhale.board.device import Device
from greywhale.board.doctor import board, link, memory, pots
from greywhale.board.doctor.finding import Finding, Verdict
from greywhale.board.doctor.port import examine_port
from greywhale.board.flash.readback import compare_image
from greywhale.board.limits import DOCTOR, PATIENCE
from greywhale.board.pots import read_counts, read_pots
from greywhale.board.refusal import upper_first
from greywhale.board.session import Session
from greywhale.board.upload import read_parameters
from greywhale.protocol import schema

AT_REST = (schema.State.DISABLED, schema.State.FAULT)


def examine(
    port: str,
    params: Path | None,
    link_s: float,
    supply_v: float | None,
    image: bool,
    hex_file: Path | None,
    report: Progress = show_no_progress,
) -> list[Finding]:
    """All findings, in the order in which a person would mend them.

    `params` is a file of parameters that the board should run; `link_s` is how long the link is loaded; `supply_v` is
    what a person measured at the motors' supply; with `image` the firmware is read back and compared with `hex_file`,
    or with the shipped one.
    """
    found = examine_port(port)
    if found[-1].verdict is Verdict.BAD:
        return found
    try:
        with Session.of(port):  # also between two openings
            with Device(port, restart=False) as device:
                found += _examine_board(device, params, link_s, supply_v, report)
                motors_on = device.status().state not in AT_REST
            found += _examine_image(port, hex_file, motors_on, report) if image else [memory.not_examined()]
    except UserError as error:
        found.append(Finding("board", Verdict.BAD, upper_first(error.message)))
    return found


def _examine_board(
    device: Device, params: Path | None, link_s: float, supply_v: float | None, report: Progress
) -> Iterator[Finding]:
    yield from board.examine_hello(device.hello, device.firmware_version)
    status = device.status()
    yield from board.examine_status(device.hello, status)
    table = read_parameters(device)
    yield from board.examine_table(table, params)
    yield board.examine_supply(table, supply_v)
    if status.state not in AT_REST:
        yield Finding("potentiometers", Verdict.NOTE, "Not looked at: the motors are on.", "Run `greywhale stop`.")
        return
    report("potentiometers", 0.0)
    rails = read_pots(device, table).complaints()
    yield from pots.examine_pots(read_counts(device, table, round(DOCTOR.rest_s * 1000)), rails)
    yield link.examine_traffic(
        link.exchange(device, table, link_s, lambda fraction: report("link", fraction)), PATIENCE.reply_wait_s
    )


def _examine_image(port: str, hex_file: Path | None, motors_on: bool, report: Progress) -> list[Finding]:
    """The firmware on the board against the image, and its memory. The board restarts, so this comes last."""
    if motors_on:
        return [memory.refused()]
    try:
        compared, boot_code = compare_image(port, hex_file, report)
        with Device(port):  # its firmware runs again
            return [memory.examine_boot_code(boot_code), memory.examine_comparison(compared)]
    except UserError as error:
        return [memory.unread(upper_first(error.message))]
