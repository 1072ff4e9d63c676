"""`greywhale info`: who answers on a port, and how it is."""

from __future__ import annotations

import contextlib
from typing import Annotated, TypedDict

import click

from greywhale.base.errors import BadUsage, counted
from greywhale.base.telling import Column, Row, Step, Table, Telling
from greywhale.base.types import Crc
from greywhale.board.device import Device
from greywhale.board.limits import DOCTOR
from greywhale.board.pots import POTS, PotReadings, read_pots
from greywhale.board.refusal import fault_text, pot_name
from greywhale.board.upload import read_parameters
from greywhale.cli import completion
from greywhale.cli.output import OnPort, json_option, option, port_option, show
from greywhale.files.arm import load_arm
from greywhale.protocol import schema
from greywhale.protocol.ports import choose_port

_COLUMNS = (Column(width=14, left=True), Column(width=1, left=True))


class PotFacts(TypedDict):
    pot: str  # leader0 to follower3
    lowest: int  # reading, 0 to 1023
    highest: int
    in_use: bool  # whether the board's parameters say that it is there (scale is not 0)
    fault: Annotated[str, ("enum", ["none", "pot_low", "pot_high"])]  # the rail that it is at


class InfoAnswer(OnPort):
    board: str  # mega2560 or nano328
    firmware: str  # version
    protocol: int  # version of the link
    schema: str  # hash of the link's declarations
    parameter_crc: Crc
    parameter_source: str  # where the running parameters came from at the start
    reset_cause: str
    state: Annotated[str, ("enum", [one.key for one in schema.State])]
    clutch: Annotated[str, ("enum", [one.key for one in schema.Clutch])]
    fault: str  # of the link reference, or none
    fault_where: int | None  # joint, potentiometer or other place of the fault
    stop_reason: str  # what last turned the motors off
    uptime_s: float
    save_state: str  # how far storing parameters is
    saves: int  # parameter sets that were stored so far, modulo 65536
    late_ticks: int  # not finished in time
    frames_bad: int  # with a wrong CRC
    rx_overruns: int  # bytes that the board lost
    telemetry_dropped: int  # samples that the board could not send
    no_rule: int  # how often no rule fired
    tick_us_max: int  # the longest tick
    pots: list[PotFacts] | None  # null while the motors are on


@click.command("info")
@option("--watch", is_flag=True, help="Show angles, errors, voltages and faults as they are, until Ctrl-C.")
@option("--seconds", "-s", type=click.FloatRange(min=0.0), help="With --watch: end after so long.")
@option(
    "--model",
    shell_complete=completion.arms,
    help="With --watch: a model.toml of `greywhale identify`; show the torques that act from outside.",
)
@port_option
@json_option(InfoAnswer)
def command(watch: bool, seconds: float | None, model: str | None, port: str | None, as_json: bool) -> None:
    """Tell a board's version, state, faults and counters, and which potentiometers are broken.

    The board is not restarted if a greywhale had its port last, so that a fault is still there to be seen. Otherwise
    opening the port restarts an Arduino: motors that were on are off afterwards, and counters start at zero.

    --watch draws a small table again and again; in a pipe it prints a line of CSV each second and at each change of
    state or fault. The motors are off meanwhile.
    """
    if watch:
        if as_json:
            raise BadUsage("--watch goes on and on, and --json prints one object; leave one of them out.")
        _watch(port, seconds, model)
        return
    if seconds is not None:
        raise BadUsage("--seconds belongs to --watch; add that, or leave it out.")
    if model is not None:
        raise BadUsage("--model belongs to --watch; add that, or leave it out.")
    with Device(choose_port(port), restart=False) as device:
        hello, status = device.hello, device.status()
        pots = read_pots(device, read_parameters(device)) if status.state in _MOTORS_OFF else None
    show(as_json, _facts(device, hello, status, pots), _tell(device, hello, status, pots))


def _watch(port: str | None, seconds: float | None, model: str | None) -> None:
    # What draws on a terminal takes a moment to import.
    from greywhale.cli.watch import watch

    arm = None if model is None else load_arm(model)
    with Device(choose_port(port), restart=False) as device, contextlib.suppress(KeyboardInterrupt):
        watch(device, read_parameters(device), seconds, arm)  # Ctrl-C is how it ends


def _facts(
    device: Device, hello: schema.HelloReply, status: schema.StatusReply, pots: PotReadings | None
) -> InfoAnswer:
    return {
        "port": device.port,
        "board": hello.board.key,
        "firmware": device.firmware_version,
        "protocol": hello.protocol,
        "schema": f"0x{hello.schema_hash:08x}",
        "parameter_crc": f"0x{hello.param_crc:04x}",
        "parameter_source": hello.param_source.key,
        "reset_cause": hello.reset_cause.key,
        "state": status.state.key,
        "clutch": status.clutch.key,
        "fault": status.fault.key,
        "fault_where": None if status.fault_where == 0xFF else status.fault_where,
        "stop_reason": status.stop_reason.key,
        "uptime_s": status.tick / 1000,
        "save_state": status.save_state.key,
        "saves": status.saves,
        "late_ticks": status.late_ticks,
        "frames_bad": status.frames_bad,
        "rx_overruns": status.rx_overruns,
        "telemetry_dropped": status.telemetry_dropped,
        "no_rule": status.no_rule,
        "tick_us_max": status.tick_us_max,
        "pots": None if pots is None else [_pot_facts(pots, number) for number in range(len(POTS))],
    }


def _pot_facts(pots: PotReadings, number: int) -> PotFacts:
    counts = pots.counts[:, number]
    return {
        "pot": POTS[number],
        "lowest": int(counts.min()),
        "highest": int(counts.max()),
        "in_use": number in pots.there,
        "fault": pots.at_rail(number).key,
    }


_MOTORS_OFF = (schema.State.DISABLED, schema.State.FAULT)


def _tell(device: Device, hello: schema.HelloReply, status: schema.StatusReply, pots: PotReadings | None) -> Telling:
    rows = [
        ("board", f"{hello.board.description} on {device.port}"),
        ("firmware", f"{device.firmware_version}, protocol {hello.protocol}, schema {hello.schema_hash:#010x}"),
        ("parameters", f"CRC {hello.param_crc:#06x}"),
        ("at the start", _source(hello, status)),
        ("last start", f"{hello.reset_cause.description}, {status.tick / 1000:.1f} s ago"),
        ("state", f"{status.state.key}: {status.state.description}"),
        ("clutch", f"{status.clutch.key}: {status.clutch.description}"),
        ("motors off by", status.stop_reason.description),
        ("fault", fault_text(status) if status.fault is not schema.Fault.NONE else "none"),
        ("longest tick", f"{status.tick_us_max} us of 1000, {status.late_ticks} late"),
        (
            "link",
            f"{counted(status.frames_bad, 'bad frame')}, {counted(status.rx_overruns, 'byte')} lost, "
            f"{counted(status.telemetry_dropped, 'sample')} dropped",
        ),
        ("rules", f"none fired {counted(status.no_rule, 'time')}" if status.no_rule else "one always fired"),
        ("saves", f"{status.saves:,}; the EEPROM is made for {DOCTOR.eeprom_writes:,}"),
        *(("pots", line) for line in _tell_pots(pots)),
    ]
    return Telling((Table(_COLUMNS, [Row(row) for row in rows]),), [Step("doctor", "Look at what may be wrong")])


def _source(hello: schema.HelloReply, status: schema.StatusReply) -> str:
    """The source of the parameters at the board's start, and a clause if a set was stored since."""
    stored = hello.param_source is schema.ParamSource.DEFAULTS and status.saves > 0
    return f"they came from {hello.param_source.description}{'; a set was stored since' if stored else ''}"


def _tell_pots(pots: PotReadings | None) -> list[str]:
    if pots is None:
        return ["not looked at: the motors are on"]
    absent = [pot_name(number) for number in range(len(POTS)) if number not in pots.there]
    complaints = pots.complaints() or ["none is at a rail; wires that touch are found by `greywhale doctor`"]
    return [*complaints, f"not in use: {', '.join(absent)}"] if absent else complaints
