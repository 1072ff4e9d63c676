"""Moves whole parameter sets: reads the running one, stages, applies and saves another, and proves that it arrived.

The board changes nothing until the whole staged set has passed its checks under the CRC that this host computed. Then
all of it changes between two ticks. So a broken upload leaves the running and the stored set as they were.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator, Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import TypedDict

from greywhale.base.errors import UserError
from greywhale.base.types import Crc, Progress, show_no_progress
from greywhale.board.device import Device
from greywhale.board.limits import PATIENCE
from greywhale.board.refusal import RefusedError
from greywhale.files import controller as controller_file
from greywhale.protocol import schema
from greywhale.protocol.table import ParameterTable

_POLL_S = 0.02  # between two looks whether the board has done it


class UploadFacts(TypedDict):
    parameter_crc: Crc
    changed: list[str]  # names of the parameters that changed


@dataclass(frozen=True)
class Uploaded:
    """The result of an upload: the set that runs and is stored, names of the parameters that changed."""

    table: ParameterTable
    changed: tuple[str, ...]

    @property
    def param_crc(self) -> int:
        return self.table.crc

    def as_dict(self) -> UploadFacts:
        return {"parameter_crc": f"0x{self.param_crc:04x}", "changed": list(self.changed)}


def read_parameters(device: Device, report: Progress = show_no_progress) -> ParameterTable:
    """Read the running set; its CRC proves that it is whole."""
    values = []
    for index in range(len(schema.PARAMETERS)):
        report("reading parameters", index / len(schema.PARAMETERS))
        reply = device.ask(schema.ParamGetRequest(index))
        if reply.index != index:
            raise UserError(f"{device.port}: asked for parameter {index}, the board answered {reply.index}; try again.")
        values.append(reply.value)
    expected = device.greet().param_crc
    computed = schema.param_crc(values)
    if computed != expected:
        raise UserError(
            f"{device.port}: the parameters read have CRC {computed:#06x}, the board's set has {expected:#06x}; "
            "try again."
        )
    return ParameterTable(tuple(values), device.hello.board, device.port)


def upload_controller(device: Device, path: str | Path, report: Progress = show_no_progress) -> Uploaded:
    """Run and store the controllers of a controller.toml; every other parameter keeps its value."""
    return change_parameters(device, controller_file.load(path).raw_values(), report)


def change_parameters(
    device: Device,
    changes: Mapping[str, int],
    report: Progress = show_no_progress,
    running: ParameterTable | None = None,
) -> Uploaded:
    """Take the running set, which is read unless given, make the `changes` (name -> raw value), run and store it."""
    if running is None:
        running = read_parameters(device, report)
    wanted = running.with_raw(changes)
    upload_set(device, wanted, report)
    pairs = zip(schema.PARAMETERS, running.raw, wanted.raw, strict=True)
    return Uploaded(wanted, tuple(parameter.name for parameter, before, after in pairs if before != after))


def upload_set(
    device: Device,
    table: ParameterTable,
    report: Progress = show_no_progress,
    save_wait_s: float = PATIENCE.save_wait_s,
) -> None:
    """Stage, apply and save a whole set, then check that the board runs it. A save may take `save_wait_s`."""
    _apply(device, table, report, save_wait_s)
    _when_not_saving(device, save_wait_s, lambda: device.ask(schema.ParamSaveRequest()))
    report("saving parameters", 0.0)
    _wait_until_saved(device, save_wait_s)
    _prove(device, table)


def run_set(device: Device, table: ParameterTable, report: Progress = show_no_progress) -> None:
    """Run a whole set without storing it: after its next start, the board runs the stored set again."""
    _apply(device, table, report, PATIENCE.save_wait_s)
    _prove(device, table)


def staging(device: Device, table: ParameterTable) -> Iterator[int]:
    """Stage a whole set, a parameter at each step; the motors may run meanwhile. Yields how many are staged."""
    for index, value in enumerate(table.raw):
        echo = device.ask(schema.ParamSetRequest(index, value))
        if (echo.index, echo.value) != (index, value):
            raise UserError(
                f"{device.port}: sent {schema.PARAMETERS[index].name} = {value}, the board understood parameter "
                f"{echo.index} = {echo.value}; nothing was changed, try again."
            )
        yield index + 1


def apply_staged(device: Device, table: ParameterTable, save_wait_s: float = PATIENCE.save_wait_s) -> None:
    """Let the board run the staged set, which must be `table`; the motors must be off."""
    _when_not_saving(device, save_wait_s, lambda: device.ask(schema.ParamApplyRequest(table.crc)))


def _apply(device: Device, table: ParameterTable, report: Progress, save_wait_s: float) -> None:
    for staged in staging(device, table):
        report("uploading parameters", staged / len(table.raw))
    apply_staged(device, table, save_wait_s)


def _prove(device: Device, table: ParameterTable) -> None:
    running = device.greet().param_crc
    if running != table.crc:
        raise UserError(
            f"{device.port}: after the upload the board runs a set with CRC {running:#06x} instead of "
            f"{table.crc:#06x}; upload again."
        )


def _when_not_saving(device: Device, wait_s: float, request: Callable[[], object]) -> None:
    """Repeat a request that the board refuses while it still writes an earlier set."""
    deadline = device.clock() + wait_s
    while True:
        try:
            request()
            return
        except RefusedError as error:
            if error.code is not schema.NackCode.BUSY_SAVING or device.clock() > deadline:
                raise
        device.wait(_POLL_S)


def _wait_until_saved(device: Device, wait_s: float) -> None:
    deadline = device.clock() + wait_s
    while True:
        state = device.status().save_state
        if state is schema.SaveState.SAVED:
            return
        if state is schema.SaveState.FAILED:
            raise UserError(
                f"{device.port}: the new parameters run, but could not be stored: {state.description}; "
                "try again, and replace the board if it happens again."
            )
        if device.clock() > deadline:
            raise UserError(
                f"{device.port}: the new parameters run, but storing them has not ended after {wait_s:g} s; "
                "reset the board and upload again."
            )
        device.wait(_POLL_S)
