"""Sockets that tell who is at their other end, where a system has them; other differences are in `system`."""

from __future__ import annotations

import errno
import socket
import struct
import sys

# Sockets whose name is no file, and which tell who is at the other end.
HAS_ABSTRACT_SOCKETS = sys.platform == "linux"

_PEER = struct.Struct("3i")  # struct ucred: process, user, group
# What Linux is asked of a TCP socket and what it answers (linux/netlink.h, linux/inet_diag.h): a head of length, type,
# flags and two numbers; then family, protocol, two bytes and all states, two ports, two addresses, interface, cookie.
_SOCK_DIAG, _BY_FAMILY, _REQUEST = 4, 20, 1
_HEAD, _WANTED, _ENDS, _ANY = (
    struct.Struct("=IHHII"),
    struct.Struct("=4BI"),
    struct.Struct("!2H16s16s"),
    struct.Struct("=3I"),
)
_ALL = 0xFFFFFFFF
_USER = struct.Struct("=I")
_USER_AT = 80  # from the start of an answer


def abstract_socket() -> socket.socket:
    """One that can be bound to a name that is no file; OSError where there is no such thing."""
    if sys.platform != "linux":
        raise OSError(errno.EAFNOSUPPORT, "this system has no abstract sockets")
    return socket.socket(socket.AF_UNIX)


def peer_of(connection: socket.socket) -> tuple[int, int]:
    """Process and user at the other end of an abstract socket, by the system's word."""
    if sys.platform != "linux":
        raise OSError(errno.EAFNOSUPPORT, "this system has no abstract sockets")
    pid, uid, _ = _PEER.unpack(connection.getsockopt(socket.SOL_SOCKET, socket.SO_PEERCRED, _PEER.size))
    return pid, uid


def owner_of(end: tuple[str, int], other: tuple[str, int]) -> int | None:
    """The user whose TCP socket on this machine has `end` as its own IPv4 address and is connected to `other`; 0 also
    where it has been closed, None where the system does not tell.
    """
    if sys.platform != "linux":
        return None
    try:
        with socket.socket(socket.AF_NETLINK, socket.SOCK_DGRAM, _SOCK_DIAG) as asked:
            asked.setblocking(False)  # the answer is there when the question has been sent
            asked.sendto(owner_question(end, other), (0, 0))
            return owner_in(asked.recv(4096))
    except OSError:
        return None


def owner_question(end: tuple[str, int], other: tuple[str, int]) -> bytes:
    """The message that asks Linux for the owner of a connection."""
    first, second = (socket.inet_aton(host).ljust(16, b"\0") for host, _ in (end, other))
    wanted = _WANTED.pack(socket.AF_INET, socket.IPPROTO_TCP, 0, 0, _ALL)
    asked = wanted + _ENDS.pack(end[1], other[1], first, second) + _ANY.pack(0, _ALL, _ALL)
    return _HEAD.pack(_HEAD.size + len(asked), _BY_FAMILY, _REQUEST, 0, 0) + asked


def owner_in(answer: bytes) -> int | None:
    """The user in an answer; None where it tells of none."""
    if len(answer) < _USER_AT + _USER.size or _HEAD.unpack_from(answer)[1] != _BY_FAMILY:
        return None
    user: int = _USER.unpack_from(answer, _USER_AT)[0]
    return user
