"""Images written page by page through each kind of bootloader, and read back: with gaps, with what a cable does."""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path

import pytest

from greywhale.base.errors import UserError
from greywhale.base.types import show_no_progress
from greywhale.board.flash.bootloader import Dialect
from greywhale.board.flash.images import Image, read_image
from greywhale.board.flash.pages import write_image
from greywhale.protocol.transport import PortDisturbedError, PortLostError
from tests.board.flash.fake_bootloader import ATMEGA328P, MEGA2560, FakeBootloader, Spoil, Version1, Version2
from tests.board.flash.hex_files import hex_text

DIALECTS = {Version1: Dialect(1, 57600), Version2: Dialect(2, 115200)}
SIGNATURES = {Version1: ATMEGA328P, Version2: MEGA2560}
Kind = type[Version1] | type[Version2]
BOTH = pytest.mark.parametrize("kind", [Version2, Version1], ids=["mega", "nano"])
PATTERN = bytes((7 * at + at // 256) % 255 for at in range(1001))  # without erased bytes, of an odd length
FAR = 0x20000


def image(folder: Path, *pieces: tuple[int, bytes]) -> Image:
    """An image of these pieces, by their addresses."""
    path = folder / "image.hex"
    parts = [hex_text(content, start) for start, content in pieces]
    path.write_text("".join(part.rsplit(":", 1)[0] for part in parts[:-1]) + parts[-1])
    return read_image(path)


def board(kind: Kind, memory: bytes = b"", spoil: Spoil = lambda kind, count: "") -> FakeBootloader:
    return kind(DIALECTS[kind].baud, SIGNATURES[kind], memory, spoil)


def write(to: FakeBootloader, what: Image, report: Callable[[str, float], None] = show_no_progress) -> None:
    kind = Version1 if isinstance(to, Version1) else Version2
    write_image(to.port, DIALECTS[kind], what, to.page, report)


def spoil(what: str, kind: str, *numbers: int) -> Spoil:
    """Let this go wrong with these questions of a kind."""
    return lambda asked, count: what if asked == kind and count in numbers else ""


@BOTH
def test_an_image_replaces_what_was_there_and_the_firmware_is_started(kind: Kind, tmp_path: Path) -> None:
    told: list[tuple[str, float]] = []
    with board(kind, bytes(4096)) as to:
        write(to, image(tmp_path, (0, PATTERN)), lambda what, fraction: told.append((what, fraction)))
        pages = -(-len(PATTERN) // to.page)
        assert to.memory[: pages * to.page] == PATTERN.ljust(pages * to.page, b"\xff")
        assert to.memory[pages * to.page : 4096] == bytes(4096 - pages * to.page)
        assert to.left
    parts = [done / pages for done in range(1, pages + 1)]
    assert told == [(what, part) for what in ("writing", "verifying") for part in parts]


def test_beyond_64_kilobytes_every_address_is_reached(tmp_path: Path) -> None:
    content = bytes(at // 256 % 255 for at in range(0x10400))
    with board(Version2) as to:
        write(to, image(tmp_path, (0, content)))
        assert to.memory[: len(content)] == content
        assert to.asked["seek"] == 5, "it goes on by itself, in writing as in reading; twice for the first page"


@BOTH
@pytest.mark.parametrize("old", [b"", bytes(FAR + 512)], ids=["blank", "full"])
def test_what_lies_behind_a_gap_is_written_over_nothing(kind: Kind, old: bytes, tmp_path: Path) -> None:
    far = FAR if kind is Version2 else 0x4000
    with board(kind, old) as to:
        write(to, image(tmp_path, (0, PATTERN), (far, PATTERN[:300])))
        assert to.memory[: len(PATTERN)] == PATTERN
        assert to.memory[far : far + 300] == PATTERN[:300]


@pytest.mark.parametrize(
    ("held", "writes"),
    [(b"", 7), (PATTERN[:300], 7), (PATTERN[:299] + b"\0", 515), (bytes(512), 515)],
    ids=["nothing", "the same", "a wrong byte", "other code"],
)
def test_a_gap_is_erased_only_where_it_must_be(held: bytes, writes: int, tmp_path: Path) -> None:
    with board(Version2, bytes(FAR) + held) as to:
        write(to, image(tmp_path, (0, PATTERN), (FAR, PATTERN[:300])))
        assert to.asked["write"] == writes
        assert to.memory[FAR : FAR + 300] == PATTERN[:300]


def test_a_page_behind_a_gap_is_not_erased_after_it_was_written(tmp_path: Path) -> None:
    """The Mega's bootloader comes to it with one of the later writes."""
    pieces = (0, PATTERN[:256]), (0x300, PATTERN)
    with board(Version2) as to:
        write(to, image(tmp_path, *pieces))
        for start, content in pieces:
            assert to.memory[start : start + len(content)] == content


@BOTH
@pytest.mark.parametrize("asked", ["write", "read", "seek"])
@pytest.mark.parametrize("what", ["question", "answer", "garbled"])
def test_what_is_lost_on_the_way_is_asked_for_again(kind: Kind, asked: str, what: str, tmp_path: Path) -> None:
    with board(kind, bytes(4096), spoil(what, asked, 0, 1)) as to:
        write(to, image(tmp_path, (0, PATTERN)))
        assert to.memory[: len(PATTERN)] == PATTERN
        assert to.left


@BOTH
@pytest.mark.parametrize(("asked", "doing"), [("write", "writing"), ("read", "reading")])
@pytest.mark.parametrize("what", ["question", "garbled"])
def test_a_bootloader_that_is_silent_or_wrong_for_good_is_named_with_the_address(
    kind: Kind, asked: str, doing: str, what: str, tmp_path: Path
) -> None:
    with board(kind, spoil=spoil(what, asked, 2, 3, 4)) as to:
        where = rf"{to.port}: the bootloader stopped answering while {doing} at address {2 * to.page:#x}; check the"
        with pytest.raises(UserError, match=f"{where} cable"):
            write(to, image(tmp_path, (0, PATTERN)))
        assert not to.left


@BOTH
def test_a_board_that_says_nothing_more_is_given_up_after_seconds(kind: Kind, tmp_path: Path) -> None:
    dead: list[int] = []

    def die(asked: str, count: int) -> str:
        if (asked, count) == ("write", 2):
            dead.append(count)
        return "question" if dead else ""

    with board(kind, spoil=die) as to:
        with pytest.raises(UserError, match="stopped answering"):
            write(to, image(tmp_path, (0, PATTERN)))
        assert to.clock() < 5.0


@BOTH
def test_a_byte_that_is_not_kept_is_named(kind: Kind, tmp_path: Path) -> None:
    def wear(asked: str, count: int) -> str:
        if (asked, count) == ("read", 0):
            to.memory[0x123] ^= 0x40
        return ""

    with board(kind, spoil=wear) as to:
        wanted = PATTERN[0x123]
        words = rf"holds {wanted ^ 0x40:#04x} at address 0x123 instead of {wanted:#04x}; flash it again"
        with pytest.raises(UserError, match=rf"^{to.port}: the board {words}"):
            write(to, image(tmp_path, (0, PATTERN)))
        assert not to.left


@BOTH
@pytest.mark.parametrize("asked", ["other", "write", "read", "leave"])
def test_a_port_that_goes_away_is_named_whenever_it_does(kind: Kind, asked: str, tmp_path: Path) -> None:
    def unplug(question: str, count: int) -> str:
        if question == asked:
            raise PortLostError(to.port)
        return ""

    with board(kind, spoil=unplug) as to, pytest.raises(UserError, match=r"went away while it was being flashed; con"):
        write(to, image(tmp_path, (0, PATTERN)))


@BOTH
def test_another_program_at_the_port_is_named_and_that_the_image_is_not_whole(kind: Kind, tmp_path: Path) -> None:
    def disturb(asked: str, count: int) -> str:
        if (asked, count) == ("write", 3):
            raise PortDisturbedError(to.port, "reads from the port too")
        return ""

    with board(kind, spoil=disturb) as to, pytest.raises(PortDisturbedError, match="reads from the port too") as caught:
        write(to, image(tmp_path, (0, PATTERN)))
    assert caught.value.__notes__ == ["The board was not flashed whole: flash it again."]


@BOTH
@pytest.mark.parametrize(("asked", "count"), [("write", 1), ("write", 3), ("read", 0), ("read", 3)])
def test_a_flash_that_ends_anywhere_leaves_a_board_that_does_nothing_and_can_be_flashed_again(
    kind: Kind, asked: str, count: int, tmp_path: Path
) -> None:
    """An old program, or half of it with half of the new one, would do anything: the first page is a loop."""

    def interrupt(what: str, before: int) -> str:
        if (what, before) == (asked, count):
            raise KeyboardInterrupt
        return ""

    with board(kind, bytes(4096), interrupt) as to:
        with pytest.raises(KeyboardInterrupt) as caught:
            write(to, image(tmp_path, (0, PATTERN)))
        assert caught.value.__notes__ == ["The board was not flashed whole: flash it again."]
        assert to.memory[: to.page] == b"\xff\xcf".ljust(to.page, b"\xff")
        assert not to.left
        to.spoil = spoil("", "write")
        write(to, image(tmp_path, (0, PATTERN)))
        assert to.memory[: len(PATTERN)] == PATTERN
        assert to.left


@BOTH
@pytest.mark.parametrize("what", ["question", "answer", "garbled"])
def test_a_first_page_whose_writing_was_lost_is_written_again_and_the_next_page_stays(
    kind: Kind, what: str, tmp_path: Path
) -> None:
    pages = -(-len(PATTERN) // kind.page)
    with board(kind, bytes(4096), spoil(what, "write", pages, pages + 1)) as to:
        write(to, image(tmp_path, (0, PATTERN)))
        assert to.memory[: len(PATTERN)] == PATTERN
        assert to.left


@BOTH
def test_a_first_page_that_is_not_kept_is_named_and_never_started(kind: Kind, tmp_path: Path) -> None:
    pages = -(-len(PATTERN) // kind.page)
    with board(kind, spoil=spoil("question", "write", *range(pages, pages + 3))) as to:
        with pytest.raises(
            UserError, match=rf"the board holds 0xff at address 0x0 instead of {PATTERN[0]:#04x}; flash it"
        ):
            write(to, image(tmp_path, (0, PATTERN)))
        assert not to.left
