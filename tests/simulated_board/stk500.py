"""STK500 as avrdude speaks it, but in simulated time: version 1 for the Nano's bootloader, version 2 for the Mega's."""

from __future__ import annotations

from greywhale_sim._board import Board

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

    def command(self, body: bytes, answer_bytes: int = 0) -> bytes:
        self.line.board.uart_send(body + b" ")
        answer = self.line.read(answer_bytes + 2)
        assert (answer[0], answer[-1]) == (0x14, 0x10)
        return answer[1:-1]

    def signature(self) -> bytes:
        return self.command(b"u", 3)

    def write_page(self, address: int, page: bytes) -> None:
        self.command(b"U" + (address // 2).to_bytes(2, "little"))
        self.command(b"d" + len(page).to_bytes(2, "big") + b"F" + page)

    def read_page(self, address: int, count: int) -> bytes:
        self.command(b"U" + (address // 2).to_bytes(2, "little"))
        return self.command(b"t" + count.to_bytes(2, "big") + b"F", count)

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

    def signature(self) -> bytes:
        return bytes(self.command(bytes([0x1D, 4, 4, 0, 0x30, 0, index, 0]))[5] for index in range(3))

    def seek(self, address: int) -> None:
        self.command(b"\x06" + (address // 2 | 0x80000000).to_bytes(4, "big"))

    def write_page(self, address: int, page: bytes) -> None:
        self.seek(address)
        self.command(b"\x13" + len(page).to_bytes(2, "big") + bytes([0xC1, 10, 0x40, 0x4C, 0x20, 0, 0]) + page)

    def read_page(self, address: int, count: int) -> bytes:
        self.seek(address)
        return self.command(b"\x14" + count.to_bytes(2, "big") + b"\x20")[2:-1]

    def leave(self) -> None:
        self.command(b"\x11\x01\x01")
