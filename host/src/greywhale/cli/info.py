"""`greywhale info`: who answers on a port, and how it is."""

from __future__ import annotations

import click

from greywhale.board.device import Device
from greywhale.board.pots import POTS, PotReadings, read_pots
from greywhale.board.refusal import fault_text
from greywhale.board.upload import read_parameters
from greywhale.cli.output import json_option, port_option, show
from greywhale.protocol import schema
from greywhale.protocol.ports import choose_port


@click.command("info")
@port_option
@json_option
def command(port: str | None, as_json: bool) -> None:
    """Tell a board's version, state, faults and counters, and which potentiometers are broken.

    The board is not restarted if a greywhale had its port last, so that a fault is still there to be seen. Otherwise
    opening the port restarts an Arduino: motors that were on are off afterwards, and counters start at zero.
    """
    with Device(choose_port(port), restart=False) as device:
        hello, status = device.hello, device.status()
        pots = read_pots(device, read_parameters(device)) if status.state in _MOTORS_OFF else None
    show(as_json, _facts(device, hello, status, pots), _text(device, hello, status, pots))


def _facts(
    device: Device, hello: schema.HelloReply, status: schema.StatusReply, pots: PotReadings | None
) -> dict[str, object]:
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
        "fault": status.fault.key,
        "fault_where": None if status.fault_where == 0xFF else status.fault_where,
        "stop_reason": status.stop_reason.key,
        "uptime_s": status.tick / 1000,
        "save_state": status.save_state.key,
        **{name: getattr(status, name) for name in _COUNTERS},
        "pots": None if pots is None else [_pot_facts(pots, number) for number in range(len(POTS))],
    }


def _pot_facts(pots: PotReadings, number: int) -> dict[str, object]:
    counts = pots.counts[:, number]
    return {
        "pot": POTS[number],
        "lowest": int(counts.min()),
        "highest": int(counts.max()),
        "fault": pots.at_rail(number).key,
    }


_MOTORS_OFF = (schema.State.DISABLED, schema.State.FAULT)
_COUNTERS = ("late_ticks", "frames_bad", "rx_overruns", "telemetry_dropped", "no_rule", "tick_us_max")


def _text(device: Device, hello: schema.HelloReply, status: schema.StatusReply, pots: PotReadings | None) -> str:
    rows = [
        ("board", f"{hello.board.description} on {device.port}"),
        ("firmware", f"{device.firmware_version}, protocol {hello.protocol}, schema {hello.schema_hash:#010x}"),
        ("parameters", f"CRC {hello.param_crc:#06x}, from: {hello.param_source.description}"),
        ("last start", f"{hello.reset_cause.description}, {status.tick / 1000:.1f} s ago"),
        ("state", f"{status.state.key}: {status.state.description}"),
        ("motors off by", status.stop_reason.description),
        ("fault", fault_text(status) if status.fault is not schema.Fault.NONE else "none"),
        ("longest tick", f"{status.tick_us_max} us of 1000, {status.late_ticks} late"),
        (
            "link",
            f"{status.frames_bad} bad frames, {status.rx_overruns} bytes lost, "
            f"{status.telemetry_dropped} samples dropped",
        ),
        ("no rule fired", f"{status.no_rule} times"),
        *(("pots", told) for told in _tell_pots(pots)),
    ]
    return "\n".join(f"{name:<14} {value}" for name, value in rows)


def _tell_pots(pots: PotReadings | None) -> list[str]:
    if pots is None:
        return ["not looked at: the motors are on"]
    return pots.complaints() or ["none is at a rail"]
