"""The port: whether it is there, whether this user may open it, and what mends that."""

from __future__ import annotations

from greywhale.base import system
from greywhale.board.doctor.finding import Finding, Verdict
from greywhale.board.refusal import upper_first
from greywhale.protocol.holder import meddler, second_user_of
from greywhale.protocol.ports import find_ports, is_bench
from greywhale.protocol.socket_line import PREFIX
from greywhale.protocol.transport import LINES

RULES_FILE = "/etc/udev/rules.d/60-greywhale.rules"
# Boards that name themselves (vendors), and the bridges on clones, by vendor and product.
_VENDORS = ("2341", "2a03")
_BRIDGES = (("1a86", "7523"), ("1a86", "55d4"), ("0403", "6001"), ("10c4", "ea60"), ("067b", "2303"))


def examine_port(port: str) -> list[Finding]:
    """Findings about a port, before it is opened; a bad one is the last."""
    if port in LINES:
        return [Finding("port", Verdict.GOOD, f"{port} is in this program.")]
    if port.startswith(PREFIX):
        return [Finding("port", Verdict.GOOD, f"{port} is a TCP port.")]
    if not system.exists(port):
        others = ", ".join(one.device for one in find_ports()) or "none"
        return [Finding("port", Verdict.BAD, f"There is no port {port}; there are: {others}.", "Plug the board in.")]
    if system.device_of(port) is None:
        return [
            Finding("port", Verdict.BAD, f"{port} is not a serial port.", "`greywhale ports` lists those there are.")
        ]
    what = "a simulated board's port" if is_bench(port) else "a serial port"
    found = [Finding("port", Verdict.GOOD, f"{port} is {what}.")]
    if system.may_open(port):
        return [*found, Finding("permission", Verdict.GOOD, "This user may open it."), *_others(port)]
    return [*found, Finding("permission", Verdict.BAD, f"This user may not open {port}.", _permission_remedy(port))]


def _others(port: str) -> list[Finding]:
    """Programs beside this one that have the port open, or may open it of their own accord."""
    if user := second_user_of(port):
        return [Finding("other programs", Verdict.NOTE, f"The port is open in {user} too.", "Close that program.")]
    if remedy := meddler(port):
        says = "A program that opens serial ports of its own accord runs on this computer."
        return [Finding("other programs", Verdict.NOTE, says, f"{upper_first(remedy)}.")]
    return []


def udev_rules() -> str:
    """Rules that let whoever sits at this machine open an Arduino's port, and keep modem software away from it."""
    then = 'MODE="0660", TAG+="uaccess", ENV{ID_MM_DEVICE_IGNORE}="1", ENV{ID_MM_PORT_IGNORE}="1"'
    lines = [
        f"# Arduino boards and their USB bridges, for greywhale. Put this into {RULES_FILE}, then:",
        "#   sudo udevadm control --reload && sudo udevadm trigger",
        *(f'SUBSYSTEM=="tty", ATTRS{{idVendor}}=="{vendor}", {then}' for vendor in _VENDORS),
        *(
            f'SUBSYSTEM=="tty", ATTRS{{idVendor}}=="{vendor}", ATTRS{{idProduct}}=="{product}", {then}'
            for vendor, product in _BRIDGES
        ),
    ]
    return "\n".join(lines)


def _permission_remedy(port: str) -> str:
    install = f"`greywhale udev | sudo tee {RULES_FILE}` lets whoever sits here open it (then plug the board in again)."
    group = system.group_of(port)
    if group in ("", "root"):
        return upper_first(install)
    return f"`sudo usermod -aG {group} $USER` and log in again; or {install}"
