"""STK500 as a host speaks it, but in simulated time: version 1 for the Nano's bootloader, version 2 for the Mega's."""

from __future__ import annotations

from greywhale._native import Board

CYCLES_PER_MS = 16_000


class Line:
    """The serial line to a board."""

    def __init__(self, board: Board) -> None:
        self.board = board
        self.buffer = b""

    def read(self, count: int, limit_ms: int = 1000) -> bytes:
        deadline = self.board.cycle + limit_ms * CYCLES_PER_MS
        while len(self.buffer) < count and self.board.cycle < deadline:
            self.board.run_until(self.board.cycle + CYCLES_PER_MS)
            self.buffer += self.board.uart_receive()
        assert len(self.buffer) >= count, f"only {self.buffer!r} came within {limit_ms} ms"
        answer, self.buffer = self.buffer[:count], self.buffer[count:]
        return answer


class Version1:
    """The Nano's bootloader: bare commands ended by a space."""

    PAGE = 128

    def __init__(self, board: Board) -> None:
        self.line = Line(board)
        board.uart_send(b"0 ")
        assert self.line.read(2) == b"\x14\x10"

    def command(self, body: bytes) -> None:
        self.line.board.uart_send(body + b" ")
        assert self.line.read(2) == b"\x14\x10"

    def write_page(self, address: int, page: bytes) -> None:
        self.command(b"U" + (address // 2).to_bytes(2, "little"))
        self.command(b"d" + len(page).to_bytes(2, "big") + b"F" + page)

    def leave(self) -> None:
        self.command(b"Q")


class Version2:
    """The Mega's bootloader: framed messages with a sequence number and a checksum."""

    PAGE = 256

    def __init__(self, board: Board) -> None:
        self.line = Line(board)
        self.sequence = 0
        assert self.command(b"\x01")[2:].endswith(b"AVRISP_2")

    def command(self, body: bytes) -> bytes:
        self.sequence = (self.sequence + 1) % 256
        message = bytes([0x1B, self.sequence]) + len(body).to_bytes(2, "big") + b"\x0e" + body
        self.line.board.uart_send(message + bytes([self.checksum(message)]))
        head = self.line.read(5)
        assert head[:2] == message[:2]
        rest = self.line.read(int.from_bytes(head[2:4], "big") + 1)
        assert self.checksum(head + rest) == 0
        assert (rest[0], rest[1]) == (body[0], 0)
        return rest[:-1]

    @staticmethod
    def checksum(data: bytes) -> int:
        total = 0
        for byte in data:
            total ^= byte
        return total

    def write_page(self, address: int, page: bytes) -> None:
        self.command(b"\x06" + (address // 2 | 0x80000000).to_bytes(4, "big"))
        self.command(b"\x13" + len(page).to_bytes(2, "big") + bytes([0xC1, 10, 0x40, 0x4C, 0x20, 0, 0]) + page)

    def leave(self) -> None:
        self.command(b"\x11\x01\x01")
