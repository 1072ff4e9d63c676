"""The telling of outside torques: of a log for `greywhale evaluate --model`, and live for `info --watch --model`."""

from __future__ import annotations

from collections.abc import Iterator

from greywhale.base.errors import counted
from greywhale.base.telling import Column, Part, Row, Sentences, Table
from greywhale.observe import ExternalTorque, Sight
from greywhale.protocol.joints import Joints

SHOWN_CONTACTS = 8  # the others are counted
_COLUMNS = (
    Column("", width=7, left=True),
    Column("outside\ntorque", "N m rms", 16),
    Column("lowest\n", "N m", 9),
    Column("highest\n", "N m", 10),
    Column("known to\n±", "N m", 9),
    Column("can be told\n", "%", 15),
)


def tell(found: ExternalTorque, joints: Joints) -> Iterator[Part]:
    """The torques of these joints, where they can be told, and the contacts."""
    facts = found.as_dict()["joints"]
    rows = []
    for joint in joints:
        one = facts[joint]
        told = 100.0 * (1.0 - sum(one["not_told"].values()))
        sizes = (one["rms_nm"], one["lowest_nm"], one["highest_nm"], one["half_width_nm"])
        rows.append(Row([f"joint {joint}", *("n/a" if one is None else f"{one:.2f}" for one in sizes), f"{told:.0f}"]))
    yield Table(_COLUMNS, rows, near=True)
    shown = [
        f"Contact: joint {one.joint} at {one.time:.2f} s, up to {one.torque:+.2f} N m, for {one.lasted:.2f} s."
        for one in found.contacts[:SHOWN_CONTACTS]
    ]
    more = len(found.contacts) - SHOWN_CONTACTS
    if more > 0:
        shown.append(f"{counted(more, 'more contact')}: --json has all.")
    yield Sentences(shown or ["No contact."], near=True)


def cell(torque: float, half_width: float, sight: int, contact: bool) -> str:
    """One joint at one moment: a torque with its interval, or why it cannot be told; a contact in any case."""
    if contact:
        return f"contact {torque:+.2f}"
    return Sight(sight).words or f"{torque:+.2f} ±{half_width:.2f}"
