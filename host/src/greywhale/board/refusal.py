"""Words for a board's refusals and faults: what is wrong, with which joint or parameter, and the remedy."""

from __future__ import annotations

import re

from greywhale.base.errors import UserError
from greywhale.protocol import schema


class RefusedError(UserError):
    """The board understood a request and said no; `code` is the reason."""

    def __init__(self, port: str, request: str, nack: schema.Nack) -> None:
        self.code = nack.code
        self.detail = nack.detail
        detail = _detail(nack)
        remedy = nack.code.remedy
        if nack.code is schema.NackCode.SET_REFUSED:
            remedy = schema.Refusal.of(nack.detail & 0xFF).remedy or remedy
        if nack.code is schema.NackCode.LEAD_REFUSED:
            remedy = schema.LeadRefusal.of(nack.detail & 0xFF).remedy or remedy
        where = f" ({detail})" if detail else ""
        asked = request.replace("_", " ")
        super().__init__(
            f"{port}: the board refused the request '{asked}': {nack.code.description}{where}: {_typed(remedy)}"
        )


def _detail(nack: schema.Nack) -> str:
    code, detail = nack.code, nack.detail
    high, low = detail >> 8, detail & 0xFF
    match code:
        case schema.NackCode.BAD_INDEX | schema.NackCode.OUT_OF_RANGE | schema.NackCode.INCONSISTENT:
            return schema.PARAMETERS[detail].name if detail < len(schema.PARAMETERS) else f"index {detail}"
        case schema.NackCode.SET_REFUSED:
            return f"joint {high}, {schema.Refusal.of(low).description}"
        case schema.NackCode.LEAD_REFUSED:
            where = f"joint {high}, " if low == schema.LeadRefusal.LIMIT else ""
            return where + schema.LeadRefusal.of(low).description
        case schema.NackCode.ERROR_TOO_LARGE:
            more = " or more" if low == 0xFF else ""
            return f"joint {high}, {low / 32:.2f} rad{more}"
        case schema.NackCode.NOT_DISABLED:
            return f"it is in state {schema.State.of(detail).key}"
        case schema.NackCode.IN_FAULT:
            return schema.Fault.of(detail).description
        case schema.NackCode.POT_BAD:
            at_low = schema.Fault.of(low) is schema.Fault.POT_LOW
            return pot_name(high) + (", at the lower rail" if at_low else ", at the upper rail or on another's wire")
        case schema.NackCode.UNKNOWN_TYPE | schema.NackCode.BAD_LENGTH:
            return f"{code.detail} is {detail}"
        case _:
            return ""


def pot_name(number: int) -> str:
    """0..3 are the leader's potentiometers, 4..7 the follower's."""
    return f"leader potentiometer {number}" if number < 4 else f"follower potentiometer {number - 4}"


def fault_text(status: schema.StatusReply) -> str:
    """The fault of a status in words, with where it is and the remedy."""
    fault, where = status.fault, status.fault_where
    place = ""
    if where != 0xFF:
        pots = (schema.Fault.POT_LOW, schema.Fault.POT_HIGH, schema.Fault.LEADER_JUMP)
        place = f" ({pot_name(where)})" if fault in pots else f" (joint {where})"
    return f"{fault.description}{place}: {_typed(fault.remedy)}"


def _typed(remedy: str) -> str:
    """The remedy within a sentence for a terminal, where nobody sees the page's button to clear a fault."""
    return re.sub("(?i)clear the fault", r"\g<0> (`greywhale stop --clear-fault`)", lower_first(remedy), count=1)


def upper_first(text: str) -> str:
    return text[:1].upper() + text[1:]


def lower_first(text: str) -> str:
    """Make a sentence fit inside another; a first word such as EEPROM keeps its capitals."""
    return text if text[1:2].isupper() else text[:1].lower() + text[1:]
