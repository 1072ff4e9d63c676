"""The greeting of a board: a firmware that speaks this host's words, or a sentence with what to do."""

from __future__ import annotations

from greywhale.base.errors import UserError
from greywhale.protocol import schema


class FirmwareError(UserError):
    """No firmware that speaks this host's words answers at the port: flashing it is the remedy."""


class NoAnswerError(UserError):
    """The board stayed silent through all repeats of a request."""


class NoGreetingError(NoAnswerError, FirmwareError):
    """The board said nothing from the opening of its port on."""


def hello_in(payload: bytes, port: str) -> schema.HelloReply:
    """The hello of the board at a port; UserError unless it was built from the same declarations as this host."""
    remedy = f"flash the firmware that belongs to this host with `greywhale flash --port {port}`."
    if not payload or payload[0] != schema.PROTOCOL:
        spoken = payload[0] if payload else "none"
        raise FirmwareError(
            f"{port}: the board speaks protocol version {spoken}, this host version {schema.PROTOCOL}; {remedy}"
        )
    try:
        hello = schema.HelloReply.unpack(payload)
    except UserError as error:
        raise UserError(f"{port}: {error.message}") from None
    if hello.schema_hash != schema.SCHEMA_HASH:
        raise FirmwareError(
            f"{port}: firmware {version(hello)} was built with schema {hello.schema_hash:#010x}, "
            f"this host with {schema.SCHEMA_HASH:#010x}; {remedy}"
        )
    return hello


def silence(port: str, patience_s: float, heard: bool) -> UserError:
    """The failure of a port at which nobody greeted within `patience_s`; `heard` says whether bytes came."""
    if heard:
        return FirmwareError(
            f"{port}: something sends data, but no greywhale firmware answers within {patience_s:g} s; "
            f"flash the board with `greywhale flash --port {port}`, or name another port."
        )
    return NoGreetingError(
        f"{port}: nothing answers within {patience_s:g} s; the board has probably no greywhale firmware: "
        f"flash it with `greywhale flash --port {port}`, or name another port."
    )


def version(hello: schema.HelloReply) -> str:
    return f"{hello.fw_major}.{hello.fw_minor}.{hello.fw_patch}"
